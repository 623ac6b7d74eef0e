#pragma once

#include "formats/files/atomic_file.h"

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace paperbake {

/// A reference to a block of an Ogawa file: its position in bytes, with the top bit set when the
/// block is data and clear when it is a group.
using OgawaBlock = std::uint64_t;
inline constexpr OgawaBlock empty_group = 0;
inline constexpr OgawaBlock empty_data = OgawaBlock{1} << 63;

/// Writes Ogawa, the container format of Alembic: a tree of groups whose leaves are blocks of data.
/// Children are written before their group; the caller keeps only their positions, and several
/// groups may share a block. The file is an AtomicFile: until commit() it is NAME.part and marked
/// as unfinished. All functions throw Error(ErrorCode::folder); after that only truncate() and the
/// destructor may be called.
class OgawaWriter {
 public:
  explicit OgawaWriter(std::filesystem::path);

  /// Writes a block of data that consists of the parts one after another. Without any bytes it
  /// writes nothing and returns empty_data.
  OgawaBlock data(std::initializer_list<std::string_view> parts);

  /// Writes a group of blocks that are in the file. Without children it writes nothing and returns
  /// empty_group.
  OgawaBlock group(const std::vector<OgawaBlock>& children);

  /// The end of what is written [bytes]; truncate() drops all blocks from there on.
  std::uint64_t end() const { return end_; }
  void truncate(std::uint64_t end);
  void flush() { file_.flush(); }

  /// Marks the file as finished, with `root` as its outermost group, and gives it its name.
  void commit(OgawaBlock root);

 private:
  void append(std::string_view bytes);

  AtomicFile file_;
  std::uint64_t end_ = 0;  // [bytes] written so far
};

}  // namespace paperbake
