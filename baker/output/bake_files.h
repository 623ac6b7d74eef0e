#pragma once

#include "baker/output/write_failures.h"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace paperbake {

/// The files of a bake: what was written into its output folder, and what could not be written.
class BakeFiles {
 public:
  explicit BakeFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Calls write(path) for a file of the folder and lists it, unless the file has failed before.
  /// What write throws is recorded as the failure of this file.
  /// returns  whether it was written
  bool write(const std::string& file,
             const std::function<void(const std::filesystem::path&)>& write);

  /// Finishes a cache that keeps the frames before a failure, and lists it if it has any.
  /// wanted        frames of each of its sheets that it should have
  /// finish        returns the frames of each sheet that it has
  /// frame_number  of the n-th frame of the cache, from 0
  /// returns       what finish returned; zeros if it threw
  std::vector<std::size_t> finish_cache(const std::string& file,
                                        const std::vector<std::size_t>& wanted,
                                        const std::function<std::vector<std::size_t>()>& finish,
                                        const std::function<int(std::size_t n)>& frame_number);

  /// Lists a file that was written together with another.
  void add(const std::string& file) { written_.push_back(folder_ / file); }
  /// A picture of --debug-pictures: it may lie in any folder, and the certificate does not list it.
  void add_picture(const std::filesystem::path& picture) { pictures_.push_back(picture); }
  /// Moves the files listed after the first `count` before these.
  void move_to_front_after(std::size_t count);

  const std::filesystem::path& folder() const { return folder_; }
  /// In the order in which an artist looks for them.
  const std::vector<std::filesystem::path>& written() const { return written_; }
  const std::vector<std::filesystem::path>& pictures() const { return pictures_; }

  WriteFailures failures;  // by the names of the files in the folder

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> written_, pictures_;
};

}  // namespace paperbake
