#include "baker/output/file_hash.h"

#include "core/model/error.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"

#include <cstdio>
#include <memory>
#include <vector>

namespace paperbake {
namespace {

constexpr const char* seal_key = "\"seal\": \"";

Error unreadable(const std::filesystem::path& path) {
  return Error(ErrorCode::folder, path.string(), "There is no such file, or it cannot be read.");
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using FileHandle = std::unique_ptr<std::FILE, CloseFile>;

}  // namespace

std::string read_output(const std::filesystem::path& path) {
  if (auto text = read_file(path)) return *text;
  throw unreadable(path);
}

std::string sealed(std::string text) {
  text.erase(text.find_last_of('}'));
  while (!text.empty() && text.back() == '\n') text.pop_back();
  text += ",\n ";
  return text + seal_key + hex(content_hash(text)) + "\"\n}\n";
}

bool seal_holds(const std::string& text) {
  const std::size_t at = text.rfind(seal_key);
  return at != std::string::npos &&
         text.substr(at) ==
             seal_key + hex(content_hash(std::string_view(text).substr(0, at))) + "\"\n}\n";
}

std::string file_hash(const std::filesystem::path& path) {
  // in parts, because caches have hundreds of megabytes: read whole or mapped they would be most of
  // the memory that a bake takes
  constexpr std::size_t part = std::size_t(1) << 18;
  const FileHandle file(kind_of_no_file(path).empty() ? std::fopen(path.c_str(), "rbe") : nullptr);
  if (!file) throw unreadable(path);
  ContentHasher hasher;
  std::vector<char> bytes(part);
  while (const std::size_t count = std::fread(bytes.data(), 1, part, file.get()))
    hasher.add({bytes.data(), count});
  if (std::ferror(file.get())) throw unreadable(path);
  return hex(hasher.key());
}

}  // namespace paperbake
