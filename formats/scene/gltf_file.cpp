#include "formats/scene/gltf_file.h"

#include "core/model/error.h"
#include "formats/files/atomic_file.h"
#include "formats/files/json.h"
#include "formats/scene/scene_import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string_view>

namespace paperbake {
namespace {

using gltf::index;
using gltf::list;
using gltf::refuse;
using gltf::text;
using gltf::whole;

constexpr std::size_t max_zeros = 10000000;  // elements of an accessor without a buffer view

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (int i = 3; i >= 0; --i) number = number << 8 | static_cast<unsigned char>(bytes[at + i]);
  return number;
}

struct Chunks {
  std::string json, binary;
};

/// The two chunks of a GLB file; all of a .gltf file is JSON.
Chunks chunks_of(std::string bytes) {
  if (bytes.compare(0, 4, "glTF") != 0) return {std::move(bytes), ""};
  Chunks chunks;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::size_t size = little_endian(bytes, at), type = little_endian(bytes, at + 4);
    if (size > bytes.size() - at - 8) refuse("a chunk is longer than the file");
    if (type == 0x4E4F534A && chunks.json.empty()) chunks.json = bytes.substr(at + 8, size);
    if (type == 0x004E4942 && chunks.binary.empty()) chunks.binary = bytes.substr(at + 8, size);
    at += 8 + size;
  }
  return chunks;
}

std::string from_base64(std::string_view text) {
  std::string bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char c : text) {
    const int digit = 'A' <= c && c <= 'Z'   ? c - 'A'
                      : 'a' <= c && c <= 'z' ? c - 'a' + 26
                      : '0' <= c && c <= '9' ? c - '0' + 52
                      : c == '+' || c == '-' ? 62
                      : c == '/' || c == '_' ? 63
                                             : -1;
    if (digit < 0) continue;
    group = (group << 6 | digit) & 0xFFFFFF;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<char>(group >> bits));
    }
  }
  return bytes;
}

/// "my%20sheet.bin" -> "my sheet.bin"
std::string without_escapes(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() &&
                        std::isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
                        std::isxdigit(static_cast<unsigned char>(uri[i + 2]));
    text.push_back(
        escape ? static_cast<char>(std::stoi(std::string(uri.substr(i + 1, 2)), nullptr, 16))
               : uri[i]);
    if (escape) i += 2;
  }
  return text;
}

/// The bytes of a data URI: "data:;base64,AAAA".
std::string bytes_of_data(std::string_view uri) {
  const std::size_t comma = std::min(uri.find(','), uri.size());
  const std::string bytes = without_escapes(uri.substr(std::min(comma + 1, uri.size())));
  return uri.substr(0, comma).find(";base64") == std::string_view::npos ? bytes
                                                                        : from_base64(bytes);
}

/// A name for a sentence: without line ends and other control characters, and not too long.
std::string printable(std::string name) {
  constexpr std::size_t most = 200;
  for (char& c : name)
    if ((c >= 0 && c < ' ') || c == 127) c = '?';
  return name.size() > most ? name.substr(0, most) + "..." : name;
}

/// Does a path lead into the folder of the scene or below it, whatever links are on the way?
bool is_in_folder_of(const std::filesystem::path& scene, const std::filesystem::path& part) {
  std::error_code unknown;
  const auto folder =
      std::filesystem::canonical(scene.has_parent_path() ? scene.parent_path() : ".", unknown);
  if (unknown) return false;
  const auto place = std::filesystem::weakly_canonical(part, unknown);
  return !unknown &&
         std::mismatch(folder.begin(), folder.end(), place.begin(), place.end()).first ==
             folder.end();
}

std::string bytes_beside(const std::filesystem::path& file, const std::string& uri, Parts parts) {
  if (uri.find("://") != std::string::npos)
    throw Error(ErrorCode::scene, file.string(),
                fmt::format("A part of the file is elsewhere: \"{}\".", uri),
                "Export the scene as one .glb file.");
  std::string no_file;
  for (const std::string& name : {without_escapes(uri), uri}) {
    const auto part = file.parent_path() / name;
    if (parts == Parts::of_its_folder && !is_in_folder_of(file, part))
      throw Error(
          ErrorCode::scene, file.string(),
          fmt::format("A part of the file, \"{}\", lies outside its folder.", printable(name)),
          "If you trust the scene, bake with --allow-outside; or export it as one .glb file.");
    if (auto bytes = read_file(part)) return std::move(*bytes);
    if (no_file.empty()) no_file = kind_of_no_file(part);
  }
  throw Error(ErrorCode::scene, file.string(),
              no_file.empty()
                  ? fmt::format("A part of the file, \"{}\" beside it, cannot be opened.",
                                printable(without_escapes(uri)))
                  : fmt::format("A part of the file, \"{}\", is {}, not a file.",
                                printable(without_escapes(uri)), no_file),
              "Put it there under that name, or export the scene as one .glb file.");
}

/// Refuses compressed files.
void check_extensions(const Json& json, const std::filesystem::path& path) {
  for (const Json& name : list(json, "extensionsRequired"))
    for (const char* unread :
         {"EXT_meshopt_compression", "KHR_meshopt_compression", "KHR_draco_mesh_compression"})
      if (name == unread)
        throw Error(ErrorCode::scene, path.string(),
                    fmt::format("The file is compressed ({}).", unread),
                    "Export it without compression.");
}

template <class Number>
double read(const char* at, bool normalized) {
  Number value;
  std::memcpy(&value, at, sizeof value);
  if (!normalized || !std::is_integral_v<Number>) return static_cast<double>(value);
  // source: glTF 2.0, section 3.11
  return std::max(
      static_cast<double>(value) / static_cast<double>(std::numeric_limits<Number>::max()), -1.0);
}

double number(const char* at, std::size_t type, bool normalized) {
  switch (type) {
    case 5120:
      return read<std::int8_t>(at, normalized);
    case 5121:
      return read<std::uint8_t>(at, normalized);
    case 5122:
      return read<std::int16_t>(at, normalized);
    case 5123:
      return read<std::uint16_t>(at, normalized);
    case 5125:
      return read<std::uint32_t>(at, normalized);
    case 5126:
      return read<float>(at, normalized);
    default:
      refuse(fmt::format("numbers cannot be of type {}", type));
  }
}

std::size_t size_of_type(std::size_t type) {
  return type == 5125 || type == 5126 ? 4 : type == 5122 || type == 5123 ? 2 : 1;
}

}  // namespace

namespace gltf {

void refuse(const std::string& what) { throw Damage(what); }

const Json& list(const Json& object, const char* key) {
  static const Json none = Json::array();
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (found == object.end()) return none;
  if (!found->is_array()) refuse(fmt::format("\"{}\" is not a list", key));
  return *found;
}

std::size_t whole(const Json& object, const char* key, std::optional<std::size_t> fallback) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (found == object.end() && fallback) return *fallback;
  if (found == object.end() || !found->is_number_integer() || *found < 0)
    refuse(fmt::format("\"{}\" is not a whole number of at least 0", key));
  return found->get<std::size_t>();
}

std::size_t index(const Json& object, const char* key, std::size_t count) {
  const std::size_t i = whole(object, key);
  if (i >= count) refuse(fmt::format("\"{}\" is {}, of {}", key, i, count));
  return i;
}

std::string text(const Json& object, const char* key, const std::string& fallback) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found != object.end() && found->is_string() ? found->get<std::string>() : fallback;
}

std::string name(const Json& list, std::size_t i, const char* key) {
  const std::string given = text(list[i], "name", "");
  return given.empty() ? fmt::format("{}[{}]", key, i) : given;
}

std::vector<double> numbers(const Json& object, const char* key, std::size_t count) {
  std::vector<double> found;
  for (const Json& n : list(object, key))
    if (n.is_number() && std::isfinite(n.get<double>())) found.push_back(n.get<double>());
  return found.size() == count && list(object, key).size() == count ? found : std::vector<double>();
}

}  // namespace gltf

GltfFile::GltfFile(const std::filesystem::path& path, Parts parts) : path_(path), parts_(parts) {
  auto bytes = read_file(path);
  if (!bytes) refuse("it cannot be opened");
  Chunks chunks = chunks_of(std::move(*bytes));
  try {
    json_ = parse_json(chunks.json);
  } catch (const Json::parse_error& error) {
    refuse(fmt::format("its JSON breaks off or is damaged at byte {}", error.byte));
  } catch (const Json::out_of_range&) {
    refuse("a number in its JSON is too large");
  }
  binary_ = std::move(chunks.binary);
  const std::string version =
      text(json_.is_object() ? json_.value("asset", Json()) : Json(), "version", "");
  if (!version.empty() && version[0] != '2')
    throw Error(ErrorCode::scene, path.string(),
                fmt::format("This is glTF of version {}; only version 2 can be read.", version),
                "Export the scene as glTF 2.0.");
  if (version.empty()) throw foreign_file(path);
  check_extensions(json_, path);
}

const std::string& GltfFile::buffer(std::size_t i) {
  if (const auto known = buffers_.find(i); known != buffers_.end()) return known->second;
  const std::string uri = text(list(json_, "buffers")[i], "uri", "");
  if (uri.empty() && i > 0) refuse(fmt::format("its buffer {} has no bytes", i));
  return buffers_[i] = uri.empty()                  ? binary_
                       : uri.rfind("data:", 0) == 0 ? bytes_of_data(uri)
                                                    : bytes_beside(path_, uri, parts_);
}

/// The elements of an accessor in the bytes of its buffer.
struct GltfFile::ElementView {
  const char* first;
  std::size_t stride;  // [bytes]
};

/// The elements of an accessor.
/// view_of, view_index  the buffer views, and the one of the accessor
/// element              [bytes] size of an element
/// offset               [bytes] of the first element in the view
/// throws               Damage when the view does not contain all of them
GltfFile::ElementView GltfFile::elements(const Json& view_of, std::size_t view_index,
                                         std::size_t count, std::size_t element,
                                         std::size_t offset) {
  const Json& view = view_of[view_index];
  const std::string& bytes = buffer(index(view, "buffer", list(json_, "buffers").size()));
  const std::size_t start = whole(view, "byteOffset", 0), length = whole(view, "byteLength"),
                    stride = whole(view, "byteStride", element);
  if (start > bytes.size() || length > bytes.size() - start || offset > length)
    refuse("a buffer view is longer than its buffer");
  if (count > 0 && (stride < element || element > length - offset ||
                    count - 1 > (length - offset - element) / stride))
    refuse("an accessor is longer than its view");
  return {bytes.data() + start + offset, stride};
}

template <class Value, class Read>
std::vector<Value> GltfFile::values(const Json& accessor, std::size_t width, std::size_t size,
                                    const Read& read) {
  const Json& views = list(json_, "bufferViews");
  const std::size_t count = whole(accessor, "count"), element = width * size;
  std::vector<Value> all;
  if (accessor.contains("bufferView")) {
    const ElementView from = elements(views, index(accessor, "bufferView", views.size()), count,
                                      element, whole(accessor, "byteOffset", 0));
    all.reserve(count * width);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < width; ++k)
        all.push_back(read(from.first + i * from.stride + k * size));
  } else {
    if (count > max_zeros) refuse("an accessor without data has too many elements");
    all.resize(count * width);
  }
  const auto sparse = accessor.find("sparse");
  if (sparse == accessor.end()) return all;
  const std::size_t changed = whole(*sparse, "count");
  const Json where = sparse->value("indices", Json()), what = sparse->value("values", Json());
  const std::size_t type = whole(where, "componentType"), width_of_index = size_of_type(type);
  const ElementView at = elements(views, index(where, "bufferView", views.size()), changed,
                                  width_of_index, whole(where, "byteOffset", 0));
  const ElementView by = elements(views, index(what, "bufferView", views.size()), changed, element,
                                  whole(what, "byteOffset", 0));
  for (std::size_t i = 0; i < changed; ++i) {
    const auto row =
        static_cast<std::size_t>(std::max(0.0, number(at.first + i * width_of_index, type, false)));
    if (row >= count) refuse("a sparse accessor changes an element that does not exist");
    for (std::size_t k = 0; k < width; ++k)
      all[row * width + k] = read(by.first + i * element + k * size);
  }
  return all;
}

std::vector<double> GltfFile::numbers(std::size_t accessor_index, std::size_t width,
                                      Integers integers) {
  const Json& accessor = list(json_, "accessors")[accessor_index];
  const std::size_t type = whole(accessor, "componentType");
  const std::string kind = width == 1    ? "SCALAR"
                           : width == 16 ? "MAT4"
                                         : "VEC" + std::to_string(width);
  if (text(accessor, "type", "") != kind)
    refuse(fmt::format("an accessor is not of type {}", kind));
  const bool normalized =
      integers == Integers::normalized || accessor.value("normalized", Json()) == true;
  return values<double>(accessor, width, size_of_type(type),
                        [&](const char* at) { return number(at, type, normalized); });
}

std::vector<std::size_t> GltfFile::indices(std::size_t accessor_index) {
  const Json& accessor = list(json_, "accessors")[accessor_index];
  const std::size_t type = whole(accessor, "componentType");
  if (text(accessor, "type", "") != "SCALAR" || (type != 5121 && type != 5123 && type != 5125))
    refuse("the vertex indices of faces are not whole numbers");
  return values<std::size_t>(accessor, 1, size_of_type(type), [&](const char* at) {
    return static_cast<std::size_t>(number(at, type, false));
  });
}

}  // namespace paperbake
