#pragma once

#include <array>
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

/// The hash as 32 lower-case hex digits, first byte first.
std::string hex(const ContentKey&);

}  // namespace paperbake
