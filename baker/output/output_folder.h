#pragma once

#include <filesystem>

namespace paperbake {

/// Makes a folder with its parents when it is missing.
/// option  the one that names another folder
/// throws Error(ErrorCode::folder): cannot be made, or not writable
void make_folder(const std::filesystem::path&, const char* option = "-o");

/// The folder a bake writes into, made with its parents and locked against a second bake for as
/// long as this lives.
class OutputFolder {
 public:
  /// throws Error(ErrorCode::folder): cannot be made, not writable, or another bake works in it
  explicit OutputFolder(const std::filesystem::path&);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// A folder inside it, made when missing. throws Error(ErrorCode::folder) when it is a link
  std::filesystem::path sub(const char* name) const;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

}  // namespace paperbake
