#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace paperbake {

/// A 128-bit hash of a string of bytes. Strings with equal hashes are taken to be equal; the hash
/// is not cryptographic and does not resist deliberate collisions.
using ContentKey = std::array<std::uint8_t, 16>;

/// MurmurHash3, x64 128-bit variant with seed 0: the key that Alembic stores with every sample, two
/// 64-bit halves in order, each little-endian. The hash of the empty string is zero.
///
/// source  MurmurHash3 by Austin Appleby, public domain
ContentKey content_hash(std::string_view bytes);

/// The same of bytes that come in parts, however long these are.
class ContentHasher {
 public:
  void add(std::string_view bytes);
  /// Of all bytes so far.
  ContentKey key() const;

 private:
  static constexpr std::size_t block = 16;
  std::uint64_t low_ = 0, high_ = 0, count_ = 0;
  char rest_[block] = {};  // the bytes after the last whole block
};

/// The hash as 32 lower-case hex digits, first byte first.
std::string hex(const ContentKey&);

}  // namespace paperbake
