#pragma once

#include "baker/output/write_failures.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// The files that a bake writes, and those that it could not write.
class BakeFiles {
 public:
  explicit BakeFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// Calls write(path) for a file of the folder, unless an attempt at it failed before, and lists
  /// it. What write throws is recorded as a failure.
  /// returns  whether it was written
  bool write(const std::string& file,
             const std::function<void(const std::filesystem::path&)>& write);
  /// Lists a file that was written otherwise.
  void add(const std::string& file) { written_.push_back(folder_ / file); }
  /// Lists a picture of --debug-pictures: it may lie anywhere and is no result of the bake.
  void add_picture(const std::filesystem::path& picture) { pictures_.push_back(picture); }

  /// Calls append() unless the listed files are to come first: see the definition of bake.
  /// Moves the files listed since there were `count` of them in front of the others.
  void move_to_front(std::size_t count);

  const std::filesystem::path& folder() const { return folder_; }
  /// In the order in which an artist looks for them.
  const std::vector<std::filesystem::path>& written() const { return written_; }
  const std::vector<std::filesystem::path>& pictures() const { return pictures_; }
  WriteFailures& failures() { return failures_; }
  const WriteFailures& failures() const { return failures_; }

 private:
  std::filesystem::path folder_;
  std::vector<std::filesystem::path> written_, pictures_;
  WriteFailures failures_;
};

}  // namespace paperbake
