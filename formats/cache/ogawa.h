#pragma once

#include "formats/files/atomic_file.h"

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <vector>

namespace paperbake {

/// A block of an Ogawa file as a group refers to it: its position, and the top bit when it is data.
using OgawaBlock = std::uint64_t;
inline constexpr OgawaBlock empty_group = 0;
inline constexpr OgawaBlock empty_data = OgawaBlock{1} << 63;

/// The bytes of a number as an Ogawa file has them (little-endian); a view of `value`.
template <class Number>
std::string_view bytes_of(const Number& value) {
  static_assert(std::is_arithmetic_v<Number>);
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// Streams the container under Alembic: a tree of groups over blocks of data, each child before its
/// group. Nothing but positions stays with the caller, and a block may be put into several groups.
/// The file appears under its name in commit(); before that it is NAME.part, marked as unfinished,
/// and without commit() it vanishes with the writer. All functions throw Error(Fault::folder);
/// after that the writer can only be cut, or destroyed.
class OgawaWriter {
 public:
  explicit OgawaWriter(std::filesystem::path);

  /// A block of the parts one after another; empty_data, and nothing written, when there are no
  /// bytes in them.
  OgawaBlock data(std::initializer_list<std::string_view> parts);

  /// A group of blocks written before; empty_group, and nothing written, when there are none.
  OgawaBlock group(const std::vector<OgawaBlock>& children);

  /// How much is written, and back to that: blocks from there on are forgotten.
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
