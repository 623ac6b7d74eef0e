#include "formats/cache/content_hash.h"
#include "formats/cache/crate_compression.h"
#include "formats/cache/usd_layer.h"
#include "formats/files/atomic_file.h"
#include "formats/files/bytes_of.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <string_view>
#include <tuple>

namespace paperbake::usd {
namespace {

// Numbers of the crate format.
enum Type : std::uint64_t {
  bool_type = 1,
  int_type = 3,
  float_type = 8,
  double_type = 9,
  string_type = 10,
  token_type = 11,
  float2_type = 20,
  float3_type = 24,
  float4_type = 28,
  dictionary_type = 31,
  token_list_type = 32,
  path_list_type = 34,
  token_vector_type = 41,
  specifier_type = 42,
  variability_type = 44,
  time_samples_type = 46,
  double_vector_type = 48,
  layer_offset_vector_type = 49,
  string_vector_type = 50,
};
enum SpecType : std::uint32_t { attribute = 1, prim = 6, pseudo_root = 7, relationship = 8 };

// A value: its type, these marks, and 48 bits of payload, the value itself or where it lies.
constexpr std::uint64_t is_array = 1ull << 63, is_inlined = 1ull << 62, is_compressed = 1ull << 61;
constexpr std::size_t min_compressed = 16;  // [elements] shorter arrays are never compressed
constexpr std::uint32_t end_of_set = ~0u;

std::uint64_t representation(Type type, std::uint64_t payload, std::uint64_t marks = 0) {
  return marks | static_cast<std::uint64_t>(type) << 48 | payload;
}
std::uint64_t inlined(Type type, std::uint64_t payload) {
  return representation(type, payload, is_inlined);
}

template <class Number>
std::string raw(Number value) {
  return std::string(bytes_of(value));
}
template <class Number>
std::string_view raw(const std::vector<Number>& values) {
  return bytes_of_values(values);
}

/// Preceded by its size.
std::string sized(const std::string& bytes) { return raw(std::uint64_t{bytes.size()}) + bytes; }

/// Numbers things in the order in which they are first asked for.
template <class Thing>
class Index {
 public:
  std::uint32_t operator()(const Thing& thing) {
    const auto [known, is_new] =
        numbers_.emplace(thing, static_cast<std::uint32_t>(things_.size()));
    if (is_new) things_.push_back(thing);
    return known->second;
  }
  const std::vector<Thing>& things() const { return things_; }

 private:
  std::map<Thing, std::uint32_t> numbers_;
  std::vector<Thing> things_;
};

struct Field {
  std::uint32_t token;
  std::uint64_t value;
  bool operator<(const Field& f) const {
    return std::tie(token, value) < std::tie(f.token, f.value);
  }
};

struct Spec {
  std::uint32_t path, field_set, type;
};

/// The tree of paths as the section PATHS lists it, parents before their children.
struct PathTree {
  std::vector<std::uint32_t> paths, elements, jumps;

  std::size_t add(std::uint32_t path, std::int32_t element) {
    paths.push_back(path);
    elements.push_back(static_cast<std::uint32_t>(element));
    jumps.push_back(0);
    return paths.size() - 1;
  }
  /// Says what follows an entry, after all that is below it has been added.
  void close(std::size_t entry, bool has_sibling) {
    const std::size_t next = paths.size();
    const bool has_child = next > entry + 1;
    const auto distance = static_cast<std::int32_t>(next - entry);
    const std::int32_t jump = has_child ? (has_sibling ? distance : -1) : (has_sibling ? 0 : -2);
    jumps[entry] = static_cast<std::uint32_t>(jump);
  }
};

class CrateEncoder : public Encoder {
 public:
  explicit CrateEncoder(const std::filesystem::path& path) : file_(path) {
    append(std::string(bootstrap_size, '\0'));
    token(";-)");  // properties are marked by a negative number, so none may have number 0
  }

  StoredValue store(const Value& value) override {
    return std::visit([this](const auto& v) { return stored(v); }, value);
  }

  void finish(const Layer& layer) override {
    const std::uint32_t top = paths_("/");
    number_paths(layer.root, "");
    std::vector<std::uint32_t> set{field("customLayerData", dictionary(layer.metadata)),
                                   field("defaultPrim", stored(Token{layer.root.name})),
                                   field("endTimeCode", stored(double(layer.last_frame))),
                                   field("framesPerSecond", stored(layer.fps)),
                                   field("metersPerUnit", stored(1.0)),
                                   field("primChildren", tokens({layer.root.name})),
                                   field("startTimeCode", stored(double(layer.first_frame))),
                                   field("timeCodesPerSecond", stored(layer.fps)),
                                   field("upAxis", stored(Token{"Y"}))};
    if (!layer.sub_layers.empty()) add_sub_layers(layer.sub_layers, set);
    PathTree tree;
    const std::size_t root = tree.add(top, 0);
    add_spec(top, std::move(set), pseudo_root);
    add(layer.root, "", tree, false);
    tree.close(root, false);
    write_sections(tree);
    file_.commit();
  }

 private:
  static constexpr std::size_t bootstrap_size = 88;

  void append(std::string_view bytes) {
    file_.write(bytes);
    end_ += bytes.size();
  }
  /// Arrays begin at multiples of 8, so that readers can use them where they lie.
  void align() { append(std::string((8 - end_ % 8) % 8, '\0')); }

  /// Texts end with a zero byte.
  std::uint32_t token(const std::string& text) { return tokens_(text.c_str()); }
  std::uint32_t text(const std::string& value) { return strings_(token(value)); }

  // ---- values

  /// Writes the bytes of a value unless the file has them already.
  StoredValue once(Type type, std::string_view bytes, std::uint64_t marks = 0) {
    const std::string head(raw(representation(type, 0, marks)));
    const auto [known, is_new] =
        written_.emplace(std::make_pair(head, content_hash(bytes)), StoredValue{0});
    if (!is_new) return known->second;
    align();
    known->second = representation(type, end_, marks);
    append(bytes);
    return known->second;
  }

  StoredValue stored(bool value) { return inlined(bool_type, value); }
  StoredValue stored(double value) {
    const auto narrow = static_cast<float>(value);
    if (static_cast<double>(narrow) != value) return once(double_type, raw(value));
    std::uint32_t bits;
    std::memcpy(&bits, &narrow, sizeof bits);
    return inlined(double_type, bits);
  }
  StoredValue stored(const std::string& value) { return inlined(string_type, text(value)); }
  StoredValue stored(const Token& value) { return inlined(token_type, token(value.text)); }
  StoredValue stored(const std::vector<double>& values) {
    return array(double_type, values.size(), raw(values));
  }
  StoredValue stored(const std::vector<Token>& values) {
    std::vector<std::uint32_t> numbers;
    for (const Token& value : values) numbers.push_back(token(value.text));
    return array(token_type, numbers.size(), raw(numbers));
  }
  StoredValue stored(const std::vector<int>& values) {
    if (values.size() < min_compressed) return array(int_type, values.size(), raw(values));
    return compressed_once(int_type, raw(values), values.size(), [&] {
      return sized(compressed_integers({values.begin(), values.end()}));
    });
  }
  StoredValue stored(const FloatArray& floats) {
    const std::size_t count = floats.values.size() / floats.width;
    constexpr Type types[] = {float_type, float2_type, float3_type, float4_type};
    if (floats.width > 1) return array(types[floats.width - 1], count, raw(floats.values));
    if (count >= min_compressed) {
      std::vector<float> different;
      if (few_different(floats.values, different))
        return compressed_once(float_type, raw(floats.values), count,
                               [&] { return looked_up(floats.values, different); });
    }
    return array(float_type, count, raw(floats.values));
  }

  StoredValue array(Type type, std::size_t count, std::string_view bytes) {
    if (count == 0) return representation(type, 0, is_array);
    std::string all = raw(std::uint64_t{count});
    all += bytes;
    return once(type, all, is_array);
  }

  /// An array that is compressed only if the file does not have it yet.
  template <class Compress>
  StoredValue compressed_once(Type type, std::string_view bytes, std::size_t count,
                              const Compress& compress) {
    const std::uint64_t marks = is_array | is_compressed;
    const auto [known, is_new] = written_.emplace(
        std::make_pair(raw(representation(type, 0, marks)), content_hash(bytes)), StoredValue{0});
    if (!is_new) return known->second;
    align();
    known->second = representation(type, end_, marks);
    append(raw(std::uint64_t{count}) + compress());
    return known->second;
  }

  /// Are there so few different numbers that a table of them saves room?
  static bool few_different(const std::vector<float>& values, std::vector<float>& different) {
    constexpr std::size_t most = 1024, share = 4;
    different = values;
    std::sort(different.begin(), different.end());
    different.erase(std::unique(different.begin(), different.end()), different.end());
    return different.size() <= most && different.size() * share <= values.size();
  }

  static std::string looked_up(const std::vector<float>& values,
                               const std::vector<float>& different) {
    std::vector<std::uint32_t> places;
    places.reserve(values.size());
    for (const float value : values)
      places.push_back(static_cast<std::uint32_t>(
          std::lower_bound(different.begin(), different.end(), value) - different.begin()));
    std::string bytes = "t" + raw(static_cast<std::uint32_t>(different.size()));
    bytes += raw(different);
    return bytes + sized(compressed_integers(places));
  }

  StoredValue tokens(const std::vector<std::string>& texts) {
    std::string bytes = raw(std::uint64_t{texts.size()});
    for (const std::string& name : texts) bytes += raw(token(name));
    return once(token_vector_type, bytes);
  }

  StoredValue dictionary(const std::vector<std::pair<std::string, std::string>>& pairs) {
    std::string bytes = raw(std::uint64_t{pairs.size()});
    constexpr std::int64_t to_value = 8;  // from here to the representation of the value
    for (const auto& [key, value] : pairs)
      bytes += raw(text(key)) + raw(to_value) + raw(stored(value));
    return once(dictionary_type, bytes);
  }

  /// head: which lists of changes there are
  StoredValue list(Type type, char head, const std::vector<std::uint32_t>& items) {
    std::string bytes = head + raw(std::uint64_t{items.size()});
    bytes += raw(items);
    return once(type, bytes);
  }

  StoredValue time_samples(const std::vector<TimeSample>& samples) {
    std::string times = raw(std::uint64_t{samples.size()});
    for (const TimeSample& sample : samples) times += raw(double(sample.time_code));
    constexpr std::int64_t to_next = 8;  // both parts follow at once
    std::string bytes = raw(to_next) + raw(once(double_vector_type, times)) + raw(to_next) +
                        raw(std::uint64_t{samples.size()});
    for (const TimeSample& sample : samples) bytes += raw(sample.value);
    return once(time_samples_type, bytes);
  }

  // ---- prims

  /// Numbers the paths of all prims, which relationships refer to.
  void number_paths(const Prim& prim, const std::string& parent) {
    const std::string path = parent + "/" + prim.name;
    paths_(path);
    for (const Prim& child : prim.children) number_paths(child, path);
  }

  void add_sub_layers(const std::vector<std::string>& paths, std::vector<std::uint32_t>& set) {
    std::string texts = raw(std::uint64_t{paths.size()}), offsets = texts;
    for (const std::string& path : paths) {
      texts += raw(text("./" + path));
      offsets += raw(0.0) + raw(1.0);  // time: offset and scale
    }
    set.push_back(field("subLayers", once(string_vector_type, texts)));
    set.push_back(field("subLayerOffsets", once(layer_offset_vector_type, offsets)));
  }

  std::uint32_t field(const char* name, StoredValue value) {
    return fields_(Field{token(name), value});
  }

  void add_spec(std::uint32_t path, std::vector<std::uint32_t> fields, SpecType type) {
    fields.push_back(end_of_set);
    specs_.push_back({path, field_sets_(fields), type});
  }

  void add(const Prim& item, const std::string& parent, PathTree& tree, bool has_sibling) {
    const std::string path = parent + "/" + item.name;
    const bool is_over = item.type.empty();
    std::vector<std::uint32_t> set{field("specifier", inlined(specifier_type, is_over))};
    if (!is_over) set.push_back(field("typeName", stored(Token{item.type})));
    if (!item.kind.empty()) set.push_back(field("kind", stored(Token{item.kind})));
    if (!item.display_name.empty()) set.push_back(field("displayName", stored(item.display_name)));
    if (!item.api_schemas.empty()) {
      std::vector<std::uint32_t> schemas;
      for (const std::string& schema : item.api_schemas) schemas.push_back(token(schema));
      constexpr char has_prepended = 1 << 5;
      set.push_back(field("apiSchemas", list(token_list_type, has_prepended, schemas)));
    }
    std::vector<std::string> properties, children;
    for (const Property& property : item.properties) properties.push_back(property.name);
    for (const Prim& child : item.children) children.push_back(child.name);
    if (!properties.empty()) set.push_back(field("properties", tokens(properties)));
    if (!children.empty()) set.push_back(field("primChildren", tokens(children)));
    const std::uint32_t number = paths_(path);
    const std::size_t entry = tree.add(number, static_cast<std::int32_t>(token(item.name)));
    add_spec(number, std::move(set), prim);
    for (std::size_t p = 0; p < item.properties.size(); ++p)
      add(item.properties[p], path, tree, p + 1 < item.properties.size() || !item.children.empty());
    for (std::size_t c = 0; c < item.children.size(); ++c)
      add(item.children[c], path, tree, c + 1 < item.children.size());
    tree.close(entry, has_sibling);
  }

  void add(const Property& property, const std::string& parent, PathTree& tree, bool has_sibling) {
    const bool relates = property.type.empty();
    std::vector<std::uint32_t> set{
        field("custom", stored(property.custom)),
        field("variability", inlined(variability_type, relates || property.uniform))};
    if (relates) {
      constexpr char is_explicit = 1 << 0 | 1 << 1;
      set.push_back(
          field("targetPaths", list(path_list_type, is_explicit, {paths_(property.target)})));
    } else {
      set.push_back(field("typeName", stored(Token{property.type})));
      if (!property.interpolation.empty())
        set.push_back(field("interpolation", stored(Token{property.interpolation})));
      set.push_back(property.varies() ? field("timeSamples", time_samples(property.samples))
                                      : field("default", property.samples.front().value));
    }
    const std::uint32_t number = paths_(parent + "." + property.name);
    const auto element = static_cast<std::int32_t>(token(property.name));
    tree.close(tree.add(number, -element), has_sibling);
    add_spec(number, std::move(set), relates ? relationship : attribute);
  }

  // ---- sections

  void write_sections(const PathTree& tree) {
    struct Section {
      const char* name;
      std::string bytes;
    };
    std::string contents;
    for (const Section& section :
         {Section{"TOKENS", tokens_section()},
          Section{"STRINGS", raw(std::uint64_t{strings_.things().size()}) +
                                 std::string(raw(strings_.things()))},
          Section{"FIELDS", fields_section()}, Section{"FIELDSETS", field_sets_section()},
          Section{"PATHS", paths_section(tree)}, Section{"SPECS", specs_section()}}) {
      align();
      char name[16] = {};
      std::strcpy(name, section.name);
      contents.append(name, sizeof name);
      contents += raw(std::int64_t(end_)) + raw(std::int64_t(section.bytes.size()));
      append(section.bytes);
    }
    align();
    std::string bootstrap("PXR-USDC\0\x08\0\0\0\0\0\0", 16);
    bootstrap += raw(std::int64_t(end_));
    append(raw(std::uint64_t{contents.size() / 32}) + contents);
    file_.write_at(0, bootstrap.data(), bootstrap.size());
  }

  std::string tokens_section() const {
    std::string texts;
    for (const std::string& token : tokens_.things()) texts += token + '\0';
    return raw(std::uint64_t{tokens_.things().size()}) + raw(std::uint64_t{texts.size()}) +
           sized(compressed(texts));
  }

  std::string fields_section() const {
    std::vector<std::uint32_t> names;
    std::vector<std::uint64_t> values;
    for (const Field& field : fields_.things()) {
      names.push_back(field.token);
      values.push_back(field.value);
    }
    return raw(std::uint64_t{names.size()}) + sized(compressed_integers(names)) +
           sized(compressed(raw(values)));
  }

  /// Specs refer to a set by the place at which it begins.
  std::string field_sets_section() {
    std::vector<std::uint32_t> all;
    for (const std::vector<std::uint32_t>& set : field_sets_.things()) {
      set_begins_.push_back(static_cast<std::uint32_t>(all.size()));
      all.insert(all.end(), set.begin(), set.end());
    }
    return raw(std::uint64_t{all.size()}) + sized(compressed_integers(all));
  }

  std::string paths_section(const PathTree& tree) const {
    return raw(std::uint64_t{tree.paths.size()}) + raw(std::uint64_t{tree.paths.size()}) +
           sized(compressed_integers(tree.paths)) + sized(compressed_integers(tree.elements)) +
           sized(compressed_integers(tree.jumps));
  }

  std::string specs_section() const {
    std::vector<std::uint32_t> paths, sets, types;
    for (const Spec& spec : specs_) {
      paths.push_back(spec.path);
      sets.push_back(set_begins_.at(spec.field_set));
      types.push_back(spec.type);
    }
    return raw(std::uint64_t{paths.size()}) + sized(compressed_integers(paths)) +
           sized(compressed_integers(sets)) + sized(compressed_integers(types));
  }

  AtomicFile file_;
  std::uint64_t end_ = 0;  // [bytes] of the file
  Index<std::string> tokens_;
  Index<std::uint32_t> strings_;  // numbers of tokens
  Index<Field> fields_;
  Index<std::vector<std::uint32_t>> field_sets_;
  std::vector<std::uint32_t> set_begins_;
  Index<std::string> paths_;
  std::vector<Spec> specs_;
  // by type and content
  std::map<std::pair<std::string, ContentKey>, StoredValue> written_;
};

}  // namespace

std::unique_ptr<Encoder> make_crate_encoder(const std::filesystem::path& path) {
  return std::make_unique<CrateEncoder>(path);
}

}  // namespace paperbake::usd
