#pragma once

#include "formats/cache/ogawa.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace paperbake {

/// Reads the files of OgawaWriter. Nothing in the file is trusted: every function returns or throws
/// for any bytes whatsoever; it throws Error(ErrorCode::scene) with the file and what is wrong with
/// it.
class OgawaReader {
 public:
  explicit OgawaReader(std::filesystem::path);

  OgawaBlock root() const { return root_; }
  std::string data(OgawaBlock) const;
  std::vector<OgawaBlock> group(OgawaBlock) const;
  std::uint64_t data_size(OgawaBlock) const;  // [bytes]

  [[noreturn]] void refuse(const std::string& cause) const;

 private:
  std::uint64_t count_at(std::uint64_t position, std::uint64_t bytes_each) const;
  void read(std::uint64_t position, void* bytes, std::uint64_t count) const;

  std::filesystem::path path_;
  mutable std::ifstream file_;
  std::uint64_t size_ = 0;  // [bytes]
  OgawaBlock root_ = empty_group;
};

}  // namespace paperbake
