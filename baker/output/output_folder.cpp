#include "baker/output/output_folder.h"

#include "core/model/error.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace paperbake {

void make_folder(const std::filesystem::path& path, const char* option) {
  std::error_code failed;
  std::filesystem::create_directories(path, failed);
  if (failed || !std::filesystem::is_directory(path))
    throw Error(
        ErrorCode::folder, path.string(),
        "The output folder cannot be made: " +
            (failed && failed != std::errc::not_a_directory ? failed.message()
                                                            : std::string("a file is in the way")) +
            ".",
        std::string("Choose another with ") + option + ".");
  if (::access(path.c_str(), W_OK) != 0)
    throw Error(ErrorCode::folder, path.string(),
                std::string("The output folder is not writable: ") + std::strerror(errno) + ".",
                std::string("Choose another with ") + option + ".");
}

OutputFolder::OutputFolder(const std::filesystem::path& path) : path_(path) {
  make_folder(path_);
  const auto lock = sub(".state") / "lock";
  lock_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (lock_ < 0)
    throw Error(ErrorCode::folder, path_.string(),
                std::string("The output folder is not writable: ") + std::strerror(errno) + ".",
                "Choose another with -o.");
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    throw Error(ErrorCode::folder, path_.string(), "Another bake is working in this folder.",
                "Wait for it, or choose another folder with -o.");
  }
}

OutputFolder::~OutputFolder() { ::close(lock_); }

std::filesystem::path OutputFolder::sub(const char* name) const {
  std::error_code none;
  if (std::filesystem::is_symlink(path_ / name, none))
    throw Error(ErrorCode::folder, (path_ / name).string(),
                "This is a link, and a bake writes into its own folder only.",
                "Remove the link, or choose another folder with -o.");
  make_folder(path_ / name);
  return path_ / name;
}

}  // namespace paperbake
