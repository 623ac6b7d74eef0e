#include "baker/output/file_hash.h"

#include "core/model/error.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"

namespace paperbake {
namespace {

constexpr const char* seal_key = "\"seal\": \"";

}  // namespace

std::string read_output(const std::filesystem::path& path) {
  if (auto text = read_file(path)) return *text;
  throw Error(ErrorCode::folder, path.string(), "There is no such file, or it cannot be read.");
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
  return hex(content_hash(read_output(path)));
}

}  // namespace paperbake
