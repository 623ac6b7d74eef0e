#pragma once

#include "core/model/sheet.h"
#include "formats/files/json.h"
#include "formats/scene/scene_parts.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// A .gltf or .glb file of version 2: its JSON, and the numbers that its accessors refer to, dense
/// or sparse, in the file itself, in data URIs or in files beside it. Nothing in the file is
/// trusted.
/// source  glTF 2.0
class GltfFile {
 public:
  /// throws Error(ErrorCode::scene) at `path` for another version or an unsupported compression;
  /// Damage or Json::exception for a damaged file
  GltfFile(const std::filesystem::path& path, Parts);

  const Json& json() const { return json_; }

  // How integers become numbers: as fractions of the largest, or as the accessor's flag says.
  enum class Integers { normalized, as_flagged };

  /// The elements of an accessor: count x width numbers, one row per element.
  /// throws Error(ErrorCode::scene) at `path` when a buffer is missing; Damage or Json::exception
  /// for a damaged file
  std::vector<double> numbers(std::size_t accessor, std::size_t width, Integers);

  /// The elements of an accessor of vertex indices. Throws as numbers() does.
  std::vector<std::size_t> indices(std::size_t accessor);

 private:
  struct ElementView;
  const std::string& buffer(std::size_t i);
  ElementView elements(const Json& view_of, std::size_t view, std::size_t count,
                       std::size_t element, std::size_t offset);
  template <class Value, class Read>
  std::vector<Value> values(const Json& accessor, std::size_t width, std::size_t size,
                            const Read& read);

  std::filesystem::path path_;
  Parts parts_;
  Json json_;
  std::string binary_;                          // binary chunk of a GLB
  std::map<std::size_t, std::string> buffers_;  // loaded on demand
};

namespace gltf {

/// Throws Damage: what is wrong in a file.
[[noreturn]] void refuse(const std::string& what);

/// The array with this key; an empty one when the object has no such member.
const Json& list(const Json& object, const char* key);

/// The non-negative integer with this key; `fallback` when the object has no such member.
std::size_t whole(const Json& object, const char* key, std::optional<std::size_t> fallback = {});

/// The non-negative integer with this key, which must be below `count`.
std::size_t index(const Json& object, const char* key, std::size_t count);

/// The text with this key; `fallback` when there is no such member or it is not a text.
std::string text(const Json& object, const char* key, const std::string& fallback);

/// The name of entry i of a list, or KEY[i] when it has none: "nodes[3]".
std::string name(const Json& list, std::size_t i, const char* key);

/// The array of `count` numbers with this key; empty when it has another length or other content.
std::vector<double> numbers(const Json& object, const char* key, std::size_t count);

}  // namespace gltf
}  // namespace paperbake
