#include "formats/files/atomic_file.h"

#include "core/model/error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <mutex>
#include <set>
#include <stdio_ext.h>
#include <sys/stat.h>
#include <unistd.h>

namespace paperbake {
namespace {

/// The files that are being written, for delete_unfinished_files().
struct UnfinishedFiles {
  std::mutex mutex;
  std::set<std::string> parts;
};

UnfinishedFiles& unfinished_files() {
  static auto* const files = new UnfinishedFiles;  // outlives every thread
  return *files;
}

void note_unfinished(const std::filesystem::path& part) {
  UnfinishedFiles& files = unfinished_files();
  const std::lock_guard lock(files.mutex);
  files.parts.insert(part.string());
}

void forget_unfinished(const std::filesystem::path& part) {
  UnfinishedFiles& files = unfinished_files();
  const std::lock_guard lock(files.mutex);
  files.parts.erase(part.string());
}

/// A file of this name that nobody else had before, open for writing and reading. null: errno says
/// why not
std::FILE* create_new(const std::filesystem::path& path) {
  ::unlink(path.c_str());
  const int fd = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  return fd < 0 ? nullptr : ::fdopen(fd, "wb+");
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path path)
    : path_(std::move(path)), part_(path_), file_(nullptr) {
  // a folder of this name would otherwise be noticed only in commit(), after all the work
  if (std::error_code none; std::filesystem::is_directory(path_, none)) {
    errno = EISDIR;
    fail("created");
  }
  part_ += ".part";
  file_ = create_new(part_);
  if (!file_) fail("created");
  note_unfinished(part_);
}

AtomicFile::~AtomicFile() {
  if (!file_) return;
  std::fclose(file_);
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
  forget_unfinished(part_);
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

void AtomicFile::commit(Sync sync) {
  if (std::fflush(file_) != 0) fail("written");
  // drops what truncate() left behind; end_ is 0 when a library has written the file by its name
  if (end_ > 0 && ::ftruncate(::fileno(file_), static_cast<off_t>(end_)) != 0) fail("written");
  // opened again by its name: a library may have replaced the file that file_ refers to
  if (sync == Sync::yes) {
    const int fd = ::open(part_.c_str(), O_RDONLY | O_CLOEXEC);
    const bool synced = fd >= 0 && ::fsync(fd) == 0;
    const int error = errno;
    if (fd >= 0) ::close(fd);
    errno = error;
    if (!synced) fail("written to disk");
  }
  if (std::rename(part_.c_str(), path_.c_str()) != 0) fail("given its name");
  forget_unfinished(part_);
  std::fclose(file_);
  file_ = nullptr;
}

void AtomicFile::fail(const char* doing) const {
  throw Error(ErrorCode::folder, path_.string(),
              std::string("The file cannot be ") + doing + ": " + std::strerror(errno) + ".",
              "Check free space and write permission of the folder, or choose another folder.");
}

void delete_unfinished_files() {
  UnfinishedFiles& files = unfinished_files();
  const std::lock_guard lock(files.mutex);
  for (const std::string& part : files.parts) ::unlink(part.c_str());
}

std::string kind_of_no_file(const std::filesystem::path& path) {
  struct stat is {};
  if (::stat(path.c_str(), &is) != 0 || S_ISREG(is.st_mode)) return "";
  return S_ISFIFO(is.st_mode)                         ? "a FIFO"
         : S_ISDIR(is.st_mode)                        ? "a folder"
         : S_ISSOCK(is.st_mode)                       ? "a socket"
         : S_ISCHR(is.st_mode) || S_ISBLK(is.st_mode) ? "a device"
                                                      : "no file";
}

std::optional<std::string> read_file(const std::filesystem::path& path) {
  // without O_NONBLOCK, opening a FIFO would wait for its writer
  const int fd = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  struct stat is {};
  if (fd >= 0 && (::fstat(fd, &is) != 0 || !S_ISREG(is.st_mode))) {
    ::close(fd);
    return {};
  }
  std::FILE* file = fd < 0 ? nullptr : ::fdopen(fd, "rb");
  if (!file) return {};
  std::string bytes;
  std::size_t end = 0, got;
  do {
    bytes.resize(std::max<std::size_t>(1 << 16, 2 * end));
    end += got = std::fread(bytes.data() + end, 1, bytes.size() - end, file);
  } while (got > 0);
  const bool failed = std::ferror(file) != 0;
  std::fclose(file);
  bytes.resize(end);
  return failed ? std::nullopt : std::optional(std::move(bytes));
}

void write_atomically(const std::filesystem::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit();
}

void write_quickly(const std::filesystem::path& path, std::string_view text) {
  AtomicFile file(path);
  file.write(text);
  file.commit(AtomicFile::Sync::no);
}

}  // namespace paperbake
