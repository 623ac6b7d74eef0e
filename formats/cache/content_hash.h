#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace paperbake {

/// 128 bits that stand for a run of bytes: equal keys are taken to mean equal bytes. Not proof
/// against an attacker.
using ContentKey = std::array<std::uint8_t, 16>;

/// MurmurHash3, the x64 128-bit variant with seed 0: the key Alembic stores with every sample (its
/// two 64-bit halves in order, each little-endian). The key of no bytes at all is zero.
///
/// source  Austin Appleby's public-domain algorithm
ContentKey content_hash(std::string_view bytes);

/// The key as 32 lower-case hex digits, first byte first.
std::string hex(const ContentKey&);

}  // namespace paperbake
