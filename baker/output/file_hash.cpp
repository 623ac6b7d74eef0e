#include "baker/output/file_hash.h"

#include "core/model/error.h"
#include "formats/cache/content_hash.h"
#include "formats/files/atomic_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

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
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (file < 0 || ::fstat(file, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) {
    if (file >= 0) ::close(file);
    return hex(content_hash(read_output(path)));
  }
  // mapped and not copied: caches have hundreds of megabytes
  const auto count = static_cast<std::size_t>(status.st_size);
  void* bytes = ::mmap(nullptr, count, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file, 0);
  ::close(file);
  if (bytes == MAP_FAILED) return hex(content_hash(read_output(path)));
  const std::string key = hex(content_hash({static_cast<const char*>(bytes), count}));
  ::munmap(bytes, count);
  return key;
}

}  // namespace paperbake
