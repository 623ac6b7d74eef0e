#pragma once

#include "core/model/sheet.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// A .gltf or .glb file of version 2: its JSON and the numbers behind its accessors, in the file,
/// in data URIs and in files beside it, dense or sparse. Nothing in the file is trusted. source:
/// glTF 2.0
class GltfFile {
 public:
  using Json = nlohmann::json;

  /// throws Error(Fault::scene) at `path`: another version, a compression that is not read;
  /// std::exception, in words: damaged
  explicit GltfFile(const std::filesystem::path& path);

  const Json& json() const { return json_; }

  // as_flagged: plain unless the accessor says normalized
  enum class Integers { normalized, as_flagged };

  /// count x width numbers, one row an element. throws Error(Fault::scene) at `path`: a buffer that
  /// is not there; std::runtime_error, in words: damaged
  std::vector<double> numbers(std::size_t accessor, std::size_t width, Integers);

  /// The same of vertex numbers.
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
  Json json_;
  std::string binary_;                          // of a GLB
  std::map<std::size_t, std::string> buffers_;  // as they are needed
};

namespace gltf {

/// What is wrong with the bytes of a file, in words. throws std::runtime_error
[[noreturn]] void refuse(const std::string& what);

/// A member that is a list; empty when there is none.
const nlohmann::json& list(const nlohmann::json& object, const char* key);

/// A member that is a whole number from 0 on; `fallback` when there is none.
std::size_t whole(const nlohmann::json& object, const char* key,
                  std::optional<std::size_t> fallback = {});

/// The same, below `count`.
std::size_t index(const nlohmann::json& object, const char* key, std::size_t count);

/// A member that is text, else `fallback`.
std::string text(const nlohmann::json& object, const char* key, const std::string& fallback);

/// The name of a node or mesh; without one "nodes[3]".
std::string name(const nlohmann::json& list, std::size_t i, const char* key);

/// So many numbers; none when there are not as many, or one is none.
std::vector<double> numbers(const nlohmann::json& object, const char* key, std::size_t count);

}  // namespace gltf
}  // namespace paperbake
