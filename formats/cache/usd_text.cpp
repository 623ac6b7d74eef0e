#include "core/model/error.h"
#include "formats/cache/content_hash.h"
#include "formats/cache/usd_layer.h"
#include "formats/files/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <iterator>
#include <map>
#include <unistd.h>

namespace paperbake::usd {
namespace {

/// A file of texts that has no name.
class Spool {
 public:
  /// In the folder of another file, where there is room for what it takes up.
  explicit Spool(const std::filesystem::path& beside) : path_(beside.string() + ".spool") {
    ::unlink(path_.c_str());
    const int fd = ::open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (fd < 0) fail("created");
    ::unlink(path_.c_str());
    file_ = ::fdopen(fd, "wb+");
    if (!file_) {
      ::close(fd);
      fail("created");
    }
  }
  ~Spool() { std::fclose(file_); }
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  void write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), file_) != text.size()) fail("written");
  }
  std::string read(long from, std::size_t size) {
    std::string text(size, '\0');
    if (std::fseek(file_, from, SEEK_SET) != 0 ||
        std::fread(text.data(), 1, size, file_) != text.size())
      fail("read");
    return text;
  }

 private:
  [[noreturn]] void fail(const char* done) const {
    throw Error(ErrorCode::folder, path_,
                fmt::format("A temporary file cannot be {}: {}.", done, std::strerror(errno)),
                "Check free space and write permission of the folder, or choose another folder.");
  }

  std::string path_;
  std::FILE* file_ = nullptr;
};

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text)
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else
      result += c == '\n' ? "\\n" : c >= 0 && c < ' ' ? " " : std::string(1, c);
  return result + '"';
}

// ---- values; each number has the fewest digits that read back as the same one

std::string text_of(bool value) { return value ? "1" : "0"; }
std::string text_of(double value) { return fmt::format("{}", value); }
std::string text_of(const std::string& value) { return quoted(value); }
std::string text_of(const Token& value) { return quoted(value.text); }
std::string text_of(const std::vector<double>& values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}
std::string text_of(const std::vector<int>& values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}
std::string text_of(const std::vector<Token>& values) {
  std::string text;
  for (const Token& token : values) text += (text.empty() ? "" : ", ") + quoted(token.text);
  return "[" + text + "]";
}
std::string text_of(const FloatArray& array) {
  std::string text = "[";
  auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < array.values.size(); ++i) {
    const std::size_t at = i % array.width;
    const char* before = at > 0 || i == 0 ? "" : ", ";
    fmt::format_to(out, "{}{}{}{}", before,
                   array.width == 1 ? ""
                   : at == 0        ? "("
                                    : ", ",
                   array.values[i], array.width > 1 && at + 1 == array.width ? ")" : "");
  }
  return text + "]";
}

class TextEncoder : public Encoder {
 public:
  explicit TextEncoder(const std::filesystem::path& path) : file_(path), spool_(path) {}

  StoredValue store(const Value& value) override {
    const std::string text = std::visit([](const auto& v) { return text_of(v); }, value);
    const auto [known, is_new] = numbers_.emplace(content_hash(text), texts_.size());
    if (is_new) {
      spool_.write(text);
      texts_.push_back({end_, text.size()});
      end_ += static_cast<long>(text.size());
    }
    return known->second;
  }

  void finish(const Layer& layer) override {
    std::string metadata;
    for (const auto& [key, value] : layer.metadata)
      metadata += fmt::format("        string {} = {}\n", key, quoted(value));
    std::string sub_layers;
    for (const std::string& path : layer.sub_layers)
      sub_layers += fmt::format("{}        @./{}@", sub_layers.empty() ? "" : ",\n", path);
    if (!sub_layers.empty()) sub_layers = fmt::format("    subLayers = [\n{}\n    ]\n", sub_layers);
    file_.write(
        fmt::format("#usda 1.0\n(\n    customLayerData = {{\n{}    }}\n    defaultPrim = {}\n    "
                    "endTimeCode = {}\n    framesPerSecond = {}\n    metersPerUnit = 1\n    "
                    "startTimeCode = {}\n{}    timeCodesPerSecond = {}\n    upAxis = \"Y\"\n)\n\n",
                    metadata, quoted(layer.root.name), layer.last_frame, layer.fps,
                    layer.first_frame, sub_layers, layer.fps));
    write(layer.root, "");
    file_.commit();
  }

 private:
  struct StoredText {
    long from;
    std::size_t size;
  };
  std::string text(StoredValue value) {
    return spool_.read(texts_.at(value).from, texts_.at(value).size);
  }

  void write(const Prim& prim, const std::string& indent) {
    std::string metadata;
    const auto add = [&](const std::string& line) { metadata += indent + "    " + line + "\n"; };
    if (!prim.api_schemas.empty()) {
      std::vector<Token> schemas;
      for (const std::string& name : prim.api_schemas) schemas.push_back({name});
      add("prepend apiSchemas = " + text_of(schemas));
    }
    if (!prim.display_name.empty()) add("displayName = " + quoted(prim.display_name));
    if (!prim.kind.empty()) add("kind = " + quoted(prim.kind));
    file_.write(indent + (prim.type.empty() ? "over " : "def " + prim.type + " ") +
                quoted(prim.name));
    if (!metadata.empty()) file_.write(fmt::format(" (\n{}{})", metadata, indent));
    file_.write(fmt::format("\n{}{{\n", indent));
    for (const Property& property : prim.properties) write(property, indent + "    ");
    for (const Prim& child : prim.children) write(child, indent + "    ");
    file_.write(indent + "}\n");
  }

  void write(const Property& property, const std::string& indent) {
    if (property.type.empty())
      return file_.write(fmt::format("{}rel {} = <{}>\n", indent, property.name, property.target));
    const std::string declaration =
        fmt::format("{}{} {}", property.uniform ? "uniform " : "", property.type, property.name);
    const std::string meaning = property.interpolation.empty()
                                    ? ""
                                    : fmt::format(" (\n{0}    interpolation = {1}\n{0})", indent,
                                                  quoted(property.interpolation));
    const char* custom = property.custom ? "custom " : "";
    if (!property.varies())
      return file_.write(fmt::format("{}{}{} = {}{}\n", indent, custom, declaration,
                                     text(property.samples.front().value), meaning));
    if (!meaning.empty())
      file_.write(fmt::format("{}{}{}{}\n", indent, custom, declaration, meaning));
    file_.write(fmt::format("{}{}.timeSamples = {{\n", indent, declaration));
    for (const TimeSample& sample : property.samples)
      file_.write(fmt::format("{}    {}: {},\n", indent, sample.time_code, text(sample.value)));
    file_.write(indent + "}\n");
  }

  AtomicFile file_;
  Spool spool_;
  long end_ = 0;  // [bytes] of the spool
  std::vector<StoredText> texts_;
  std::map<ContentKey, StoredValue> numbers_;
};

}  // namespace

std::unique_ptr<Encoder> make_text_encoder(const std::filesystem::path& path) {
  return std::make_unique<TextEncoder>(path);
}

}  // namespace paperbake::usd
