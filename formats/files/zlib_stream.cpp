#include "formats/files/zlib_stream.h"

#include <algorithm>
#include <vector>

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

std::string zlib_stream(const char* bytes, std::size_t count) {
  std::string packed(longest(count), '\0');
  std::vector<std::uint8_t> tables(ISAL_DEF_LVL1_DEFAULT);
  isal_zstream stream = {};  // the library leaves parts of it as they are
  isal_deflate_init(&stream);
  stream.level = 1;
  stream.level_buf = tables.data();
  stream.level_buf_size = static_cast<std::uint32_t>(tables.size());
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
          static_cast<std::uint32_t>(std::min(part, packed.size() - written));
      stream.next_out = reinterpret_cast<std::uint8_t*>(packed.data()) + written;
      stream.avail_out = room;
      isal_deflate(&stream);
      written += room - stream.avail_out;
    } while (stream.avail_in > 0 ||
             (stream.end_of_stream && stream.internal_state.state != ZSTATE_END));
  }
  packed.resize(written);
  return packed;
}

#else

std::string zlib_stream(const char* bytes, std::size_t count) {
  std::string packed(longest(count), '\0');
  uLongf length = packed.size();
  compress2(reinterpret_cast<Bytef*>(packed.data()), &length, reinterpret_cast<const Bytef*>(bytes),
            count, 1);
  packed.resize(length);
  return packed;
}

#endif

}  // namespace paperbake
