#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace paperbake {

/// Packs bytes as zlib streams (RFC 1950), fast: by ISA-L where the build found it, in a fifth of
/// the time, else by zlib at its first level. Level 1 of ISA-L gives the same bytes on every
/// processor since 2008 (SSE 4.1).
///
/// Keeps its memory from one stream to the next. A stream should not depend on those before it;
/// that ISA-L has once packed a block differently is not explained (docs/limits.md).
class ZlibPacker {
 public:
  /// The stream, valid until the next call.
  std::string_view operator()(const char* bytes, std::size_t count);

 private:
  std::vector<char> packed_;
  std::vector<std::uint8_t> tables_;
};

/// One such stream.
std::string zlib_stream(const char* bytes, std::size_t count);

}  // namespace paperbake
