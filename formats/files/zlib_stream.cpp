#include "formats/files/zlib_stream.h"

#include <algorithm>

#ifdef PAPERBAKE_ISAL
#include <isa-l/igzip_lib.h>
#else
#include <zlib.h>
#endif

namespace paperbake {
namespace {

/// No stream is longer than this: what cannot be packed is stored in blocks with 5 bytes in front.
std::size_t longest(std::size_t count) { return count + count / 8 + 1024; }

}  // namespace

#ifdef PAPERBAKE_ISAL

std::string_view ZlibPacker::operator()(const char* bytes, std::size_t count) {
  if (packed_.size() < longest(count)) packed_.resize(longest(count));
  tables_.assign(ISAL_DEF_LVL1_DEFAULT, 0);
  isal_zstream stream = {};  // the library leaves parts of it as they are
  isal_deflate_init(&stream);
  stream.level = 1;
  stream.level_buf = tables_.data();
  stream.level_buf_size = static_cast<std::uint32_t>(tables_.size());
  stream.gzip_flag = IGZIP_ZLIB;
  // its counters have 32 bits: in parts, of which only the last ends the stream
  constexpr std::size_t part = std::size_t(1) << 30;
  std::size_t written = 0;
  for (std::size_t from = 0; from == 0 || from < count; from += part) {
    stream.next_in = reinterpret_cast<std::uint8_t*>(const_cast<char*>(bytes)) + from;
    stream.avail_in = static_cast<std::uint32_t>(std::min(part, count - from));
    stream.end_of_stream = from + part >= count;
    do {
      const std::uint32_t room =
          static_cast<std::uint32_t>(std::min(part, packed_.size() - written));
      stream.next_out = reinterpret_cast<std::uint8_t*>(packed_.data()) + written;
      stream.avail_out = room;
      isal_deflate(&stream);
      written += room - stream.avail_out;
    } while (stream.avail_in > 0 ||
             (stream.end_of_stream && stream.internal_state.state != ZSTATE_END));
  }
  return {packed_.data(), written};
}

#else

std::string_view ZlibPacker::operator()(const char* bytes, std::size_t count) {
  if (packed_.size() < longest(count)) packed_.resize(longest(count));
  uLongf length = packed_.size();
  compress2(reinterpret_cast<Bytef*>(packed_.data()), &length,
            reinterpret_cast<const Bytef*>(bytes), count, 1);
  return {packed_.data(), length};
}

#endif

std::string zlib_stream(const char* bytes, std::size_t count) {
  ZlibPacker packer;
  return std::string(packer(bytes, count));
}

}  // namespace paperbake
