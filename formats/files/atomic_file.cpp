#include "formats/files/atomic_file.h"

#include "core/model/error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <stdio_ext.h>
#include <unistd.h>

namespace paperbake {

AtomicFile::AtomicFile(std::filesystem::path path)
    : path_(std::move(path)), part_(path_), file_(nullptr) {
  // a folder of this name would otherwise be noticed only in commit(), after all the work
  if (std::filesystem::is_directory(path_)) {
    errno = EISDIR;
    fail("created");
  }
  part_ += ".part";
  file_ = std::fopen(part_.c_str(), "wb+");
  if (!file_) fail("created");
}

AtomicFile::~AtomicFile() {
  if (!file_) return;
  std::fclose(file_);
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void AtomicFile::write(const void* bytes, std::size_t count) {
  if (std::fwrite(bytes, 1, count, file_) != count) fail("written");
  end_ += count;
}

void AtomicFile::write_at(std::uint64_t position, const void* bytes, std::size_t count) {
  if (std::fseek(file_, static_cast<long>(position), SEEK_SET) != 0) fail("written");
  if (std::fwrite(bytes, 1, count, file_) != count ||
      std::fseek(file_, static_cast<long>(end_), SEEK_SET) != 0)
    fail("written");
}

void AtomicFile::truncate(std::uint64_t position) {
  __fpurge(file_);
  std::clearerr(file_);
  if (std::fseek(file_, static_cast<long>(position), SEEK_SET) != 0) fail("written");
  end_ = position;
}

void AtomicFile::flush() {
  if (std::fflush(file_) != 0) fail("written");
}

void AtomicFile::commit() {
  if (std::fflush(file_) != 0) fail("written");
  // drops what truncate() left behind; end_ is 0 when a library has written the file by its name
  if (end_ > 0 && ::ftruncate(::fileno(file_), static_cast<off_t>(end_)) != 0) fail("written");
  // opened again by its name: a library may have replaced the file that file_ refers to
  const int fd = ::open(part_.c_str(), O_RDONLY);
  if (fd < 0 || ::fsync(fd) != 0) fail("written to disk");
  ::close(fd);
  if (std::rename(part_.c_str(), path_.c_str()) != 0) fail("given its name");
  std::fclose(file_);
  file_ = nullptr;
}

void AtomicFile::fail(const char* doing) const {
  throw Error(ErrorCode::folder, path_.string(),
              std::string("The file cannot be ") + doing + ": " + std::strerror(errno) + ".",
              "Check free space and write permission of the folder, or choose another with -o.");
}

std::optional<std::string> read_file(const std::filesystem::path& path) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) return {};
  std::string bytes;
  std::size_t end = 0, got;
  do {
    bytes.resize(std::max<std::size_t>(1 << 16, 2 * end));
    end += got = std::fread(bytes.data() + end, 1, bytes.size() - end, file);
  } while (got > 0);
  const bool failed = std::ferror(file) != 0;  // a folder can be opened, but not read
  std::fclose(file);
  bytes.resize(end);
  return failed ? std::nullopt : std::optional(std::move(bytes));
}

void write_atomically(const std::filesystem::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace paperbake
