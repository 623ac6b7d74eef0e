#include "formats/files/zlib_stream.h"

#include <libdeflate.h>

#include <new>

namespace paperbake {

void ZlibPacker::Free::operator()(libdeflate_compressor* compressor) const {
  libdeflate_free_compressor(compressor);
}

ZlibPacker::ZlibPacker() : compressor_(libdeflate_alloc_compressor(1)) {
  if (!compressor_) throw std::bad_alloc();
}

std::string_view ZlibPacker::operator()(const char* bytes, std::size_t count) {
  const std::size_t longest = libdeflate_zlib_compress_bound(compressor_.get(), count);
  if (packed_.size() < longest) packed_.resize(longest);
  const std::size_t length =
      libdeflate_zlib_compress(compressor_.get(), bytes, count, packed_.data(), packed_.size());
  return {packed_.data(), length};
}

}  // namespace paperbake
