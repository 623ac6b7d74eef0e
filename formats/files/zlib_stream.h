#pragma once

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

struct libdeflate_compressor;

namespace paperbake {

/// Packs bytes as zlib streams (RFC 1950) with libdeflate at its first level. A stream depends on
/// its bytes alone: not on the processor, nor on the streams before it. Keeps its memory from one
/// stream to the next.
class ZlibPacker {
 public:
  ZlibPacker();

  /// The stream, valid until the next call.
  std::string_view operator()(const char* bytes, std::size_t count);

 private:
  struct Free {
    void operator()(libdeflate_compressor*) const;
  };
  std::unique_ptr<libdeflate_compressor, Free> compressor_;
  std::vector<char> packed_;
};

}  // namespace paperbake
