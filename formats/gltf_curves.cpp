#include "formats/gltf_curves.h"

#include "core/error.h"
#include "formats/whole_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string_view>

namespace paperbake {
namespace {

using Json = nlohmann::json;

[[noreturn]] void refuse(const std::string& what) { throw std::runtime_error(what); }

std::string bytes_of_file(const std::filesystem::path& path) {
  if (auto bytes = read_whole_file(path)) return *bytes;
  refuse(fmt::format("\"{}\" beside it cannot be opened", path.filename().string()));
}

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  for (int i = 3; i >= 0; --i) number = number << 8 | static_cast<unsigned char>(bytes[at + i]);
  return number;
}

struct Chunks {
  std::string json, binary;
};

/// The two chunks of a GLB file; a .gltf file is its JSON.
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
    const int digit = 'A' <= c && c <= 'Z' ? c - 'A' : 'a' <= c && c <= 'z' ? c - 'a' + 26 : '0' <= c && c <= '9' ? c - '0' + 52 : c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
    if (digit < 0) continue;
    group = (group << 6 | digit) & 0xFFFFFF, bits += 6;
    if (bits >= 8) bits -= 8, bytes.push_back(static_cast<char>(group >> bits));
  }
  return bytes;
}

/// "my%20sheet.bin" -> "my sheet.bin"
std::string without_escapes(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[i + 1])) && std::isxdigit(static_cast<unsigned char>(uri[i + 2]));
    text.push_back(escape ? static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16)) : uri[i]);
    if (escape) i += 2;
  }
  return text;
}

/// A member that is a list; empty when there is none.
const Json& list(const Json& object, const char* key) {
  static const Json none = Json::array();
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (found == object.end()) return none;
  if (!found->is_array()) refuse(fmt::format("\"{}\" is no list", key));
  return *found;
}

std::size_t whole(const Json& object, const char* key, std::optional<std::size_t> otherwise = {}) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (found == object.end() && otherwise) return *otherwise;
  if (found == object.end() || !found->is_number_integer() || *found < 0) refuse(fmt::format("\"{}\" is no whole number from 0 on", key));
  return found->get<std::size_t>();
}

std::size_t index(const Json& object, const char* key, std::size_t count) {
  const std::size_t i = whole(object, key);
  if (i >= count) refuse(fmt::format("\"{}\" is {}, of {}", key, i, count));
  return i;
}

std::string text(const Json& object, const char* key, const std::string& otherwise) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return found != object.end() && found->is_string() ? found->get<std::string>() : otherwise;
}

std::vector<int> node_list(const Json& object, const char* key, std::size_t nodes) {
  std::vector<int> indices;
  for (const Json& i : list(object, key)) {
    if (!i.is_number_integer() || i < 0 || i >= nodes) refuse(fmt::format("\"{}\" names a node that is not there", key));
    indices.push_back(i.get<int>());
  }
  return indices;
}

/// Numbers of an accessor, one row an element.
struct Reader {
  const Json& json;
  const std::filesystem::path& path;
  std::string binary;                            // of a GLB
  std::map<std::size_t, std::string> buffers;    // as they are needed

  const std::string& buffer(std::size_t i) {
    const auto known = buffers.find(i);
    if (known != buffers.end()) return known->second;
    const std::string uri = text(list(json, "buffers")[i], "uri", "");
    const std::size_t comma = uri.find(',');
    return buffers[i] = uri.empty() ? binary : uri.rfind("data:", 0) == 0 ? from_base64(std::string_view(uri).substr(comma == std::string::npos ? uri.size() : comma + 1))
                                                                          : bytes_of_file(path.parent_path() / without_escapes(uri));
  }

  double number(const char* at, std::size_t type) const {
    const auto as = [&](auto value) {
      std::memcpy(&value, at, sizeof value);
      return value;
    };
    switch (type) {  // integers are normalized: source: glTF 2.0, 3.11
      case 5120: return std::max(as(std::int8_t()) / 127.0, -1.0);
      case 5121: return as(std::uint8_t()) / 255.0;
      case 5122: return std::max(as(std::int16_t()) / 32767.0, -1.0);
      case 5123: return as(std::uint16_t()) / 65535.0;
      case 5126: return as(float());
      default: refuse(fmt::format("keys cannot be numbers of type {}", type));
    }
  }

  std::vector<double> numbers(std::size_t accessor_index, std::size_t width) {
    const Json& accessor = list(json, "accessors")[accessor_index];
    if (accessor.contains("sparse")) throw Error(Fault::scene, path.string(), "An animation is stored as a sparse accessor.", "Export it without sparse accessors.");
    const Json& views = list(json, "bufferViews");
    const Json& view = views[index(accessor, "bufferView", views.size())];
    const std::string& bytes = buffer(index(view, "buffer", list(json, "buffers").size()));
    const std::size_t type = whole(accessor, "componentType"), size = type == 5126 ? 4 : type == 5122 || type == 5123 ? 2 : 1;
    const std::size_t start = whole(view, "byteOffset", 0), length = whole(view, "byteLength"), offset = whole(accessor, "byteOffset", 0), count = whole(accessor, "count");
    const std::size_t stride = whole(view, "byteStride", width * size);
    const std::string kind = width == 1 ? "SCALAR" : "VEC" + std::to_string(width);
    if (text(accessor, "type", "") != kind) refuse(fmt::format("keys are not of type {}", kind));
    if (start > bytes.size() || length > bytes.size() - start || offset > length) refuse("a view is longer than its buffer");
    if (count == 0) return {};
    if (stride < width * size || width * size > length - offset || count - 1 > (length - offset - width * size) / stride) refuse("an accessor is longer than its view");
    std::vector<double> numbers;
    numbers.reserve(count * width);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < width; ++k) numbers.push_back(number(&bytes[start + offset + i * stride + k * size], type));
    return numbers;
  }
};

template <class Value>
Value value(const double* n) {
  if constexpr (std::is_same_v<Value, Vector3d>) return {n[0], n[1], n[2]};
  else return Value(n[3], n[0], n[1], n[2]);
}

/// Makes a rotation of four numbers near one; a curve of such stays in proportion with its slopes.
double scale_to_unit(const Vector3d&) { return 1; }
double scale_to_unit(const Eigen::Quaterniond& q) { return q.norm() > 1e-9 ? 1 / q.norm() : 0; }

void scale(Vector3d& v, double by) { v *= by; }
void scale(Eigen::Quaterniond& q, double by) { q.coeffs() *= by; }

template <class Value>
Track<Value> track_of(const std::vector<double>& times, const std::vector<double>& numbers, std::size_t width, const std::string& interpolation) {
  Track<Value> track;
  track.between = interpolation == "STEP" ? Between::step : interpolation == "CUBICSPLINE" ? Between::cubic : Between::line;
  const bool cubic = track.between == Between::cubic;
  const std::size_t each = (cubic ? 3 : 1) * width;
  if (numbers.size() != times.size() * each) refuse(fmt::format("a sampler has {} times and {} values", times.size(), numbers.size() / width));
  std::vector<std::size_t> order(times.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return times[a] < times[b]; });
  for (const std::size_t k : order) {
    const double* n = &numbers[k * each];
    Value p = value<Value>(n + (cubic ? width : 0));
    const double unit = scale_to_unit(p);
    if (unit > 0) scale(p, unit);
    else if constexpr (!std::is_same_v<Value, Vector3d>) p = Value::Identity();
    track.keys.push_back({times[k], p});
    if (!cubic) continue;
    track.slopes.push_back({value<Value>(n), value<Value>(n + 2 * width)});
    scale(track.slopes.back().in, unit), scale(track.slopes.back().out, unit);
  }
  if constexpr (!std::is_same_v<Value, Vector3d>) make_continuous(track);
  return track;
}

void read_channel(Reader& reader, const Json& channel, const Json& samplers, Take& take) {
  const Json& nodes = list(reader.json, "nodes");
  const auto target = channel.find("target");
  if (target == channel.end() || !target->is_object() || !target->contains("node")) return;  // of an extension
  const std::size_t node = index(*target, "node", nodes.size());
  const std::string path = text(*target, "path", "");
  if (path != "translation" && path != "rotation" && path != "scale") return;
  const Json& sampler = samplers[index(channel, "sampler", samplers.size())];
  const std::size_t accessors = list(reader.json, "accessors").size(), width = path == "rotation" ? 4 : 3;
  const std::vector<double> times = reader.numbers(index(sampler, "input", accessors), 1), numbers = reader.numbers(index(sampler, "output", accessors), width);
  const auto finite = [](double n) { return std::isfinite(n); };
  if (!std::all_of(times.begin(), times.end(), finite) || !std::all_of(numbers.begin(), numbers.end(), finite))
    throw Error(Fault::scene, fmt::format("node \"{}\"", text(nodes[node], "name", std::to_string(node))), "A key contains a value that is not a number.", export_again);
  const std::string interpolation = text(sampler, "interpolation", "LINEAR");
  Motion& motion = take.motions[static_cast<int>(node)];
  if (path == "rotation") motion.rotation = track_of<Eigen::Quaterniond>(times, numbers, width, interpolation);
  else (path == "scale" ? motion.scale : motion.translation) = track_of<Vector3d>(times, numbers, width, interpolation);
  motion.key_times.insert(motion.key_times.end(), times.begin(), times.end());
}

/// What a channel does not move stays as the node has it.
void fill_from_node(Motion& motion, const Json& node) {
  Eigen::Affine3d rest = Eigen::Affine3d::Identity();
  Vector3d size = Vector3d::Ones();
  const auto numbers = [&](const char* key, std::size_t count) {
    std::vector<double> found;
    for (const Json& n : list(node, key))
      if (n.is_number()) found.push_back(n.get<double>());
    const bool finite = std::all_of(found.begin(), found.end(), [](double n) { return std::isfinite(n); });
    return finite && found.size() == count ? found : std::vector<double>();
  };
  if (const auto m = numbers("matrix", 16); !m.empty()) {
    rest.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
    size = rest.linear().colwise().norm();
    if (rest.linear().determinant() < 0) size = -size;
    for (int k = 0; k < 3; ++k)
      if (size(k) != 0) rest.linear().col(k) /= size(k);
  }
  if (const auto t = numbers("translation", 3); !t.empty()) rest.translation() = Vector3d(t[0], t[1], t[2]);
  if (const auto s = numbers("scale", 3); !s.empty()) size = Vector3d(s[0], s[1], s[2]);
  Eigen::Quaterniond turn(rest.linear());
  if (const auto r = numbers("rotation", 4); !r.empty()) turn = Eigen::Quaterniond(r[3], r[0], r[1], r[2]);
  if (!(turn.norm() > 1e-9)) turn.setIdentity();
  if (motion.translation.keys.empty()) motion.translation.keys = {{0, rest.translation()}};
  if (motion.rotation.keys.empty()) motion.rotation.keys = {{0, turn.normalized()}};
  if (motion.scale.keys.empty()) motion.scale.keys = {{0, size}};
}

/// Compressions that neither this reader nor assimp undoes.
void check_compression(const Json& json, const std::filesystem::path& path) {
  for (const Json& name : list(json, "extensionsRequired"))
    for (const char* unread : {"EXT_meshopt_compression", "KHR_draco_mesh_compression", "KHR_mesh_quantization"})
      if (name == unread) throw Error(Fault::scene, path.string(), fmt::format("The file is compressed ({}).", unread), "Export it without compression.");
}

}  // namespace

GltfCurves read_gltf_curves(const std::filesystem::path& path) {
  Chunks chunks = chunks_of(bytes_of_file(path));
  const Json json = Json::parse(chunks.json);
  check_compression(json, path);
  Reader reader{json, path, std::move(chunks.binary), {}};
  const Json &nodes = list(json, "nodes"), &scenes = list(json, "scenes");
  GltfCurves curves;
  for (const Json& node : nodes) curves.children.push_back(node_list(node, "children", nodes.size()));
  if (!scenes.empty()) curves.roots = node_list(scenes[std::min(whole(json, "scene", 0), scenes.size() - 1)], "nodes", nodes.size());
  for (const Json& animation : list(json, "animations")) {
    Take take;
    take.name = text(animation, "name", "");
    const Json& samplers = list(animation, "samplers");
    for (const Json& channel : list(animation, "channels")) read_channel(reader, channel, samplers, take);
    for (auto& [node, motion] : take.motions) {
      fill_from_node(motion, nodes[node]);
      std::sort(motion.key_times.begin(), motion.key_times.end());
      motion.key_times.erase(std::unique(motion.key_times.begin(), motion.key_times.end()), motion.key_times.end());
    }
    curves.takes.push_back(std::move(take));
  }
  return curves;
}

}  // namespace paperbake
