// zlib streams: another library unpacks them, and nothing but their bytes decides what they are.

#include "formats/files/zlib_stream.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <string>

namespace paperbake {
namespace {

/// Bytes as those of a map: runs, and between them noise of a few bits.
std::string runs_and_noise(std::size_t count, int noisy, unsigned seed) {
  std::string bytes;
  std::uint32_t random = seed;
  while (bytes.size() < count) {
    random = random * 1664525u + 1013904223u;
    const std::size_t length = 1 + (random >> 8) % 700;
    if (static_cast<int>((random >> 24) % 100) < noisy)
      for (std::size_t k = 0; k < length; ++k) {
        random = random * 1664525u + 1013904223u;
        bytes += static_cast<char>(random >> 24);
      }
    else
      bytes.append(length, static_cast<char>(128));
  }
  bytes.resize(count);
  return bytes;
}

std::string unpacked(std::string_view stream, std::size_t count) {
  std::string bytes(count, '\0');
  uLongf length = count;
  const int result =
      uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                 reinterpret_cast<const Bytef*>(stream.data()), static_cast<uLong>(stream.size()));
  return result == Z_OK && length == count ? bytes : "";
}

TEST(ZlibPacker, StreamsAreUnpackedByZlib) {
  ZlibPacker pack;
  for (const int noisy : {0, 20, 100})
    for (const std::size_t count : {std::size_t(1), std::size_t(1000), std::size_t(34) << 14,
                                    (std::size_t(34) << 14) + 77, std::size_t(5000000)}) {
      const std::string bytes = runs_and_noise(count, noisy, 7);
      EXPECT_TRUE(unpacked(pack(bytes.data(), count), count) == bytes) << noisy << ", " << count;
    }
}

TEST(ZlibPacker, StreamsDoNotDependOnThoseBefore) {
  const std::string one = runs_and_noise(557056, 30, 1), other = runs_and_noise(557056, 60, 2);
  ZlibPacker fresh, used;
  const std::string alone(fresh(one.data(), one.size()));
  ASSERT_LT(alone.size(), one.size() / 2);
  used(other.data(), other.size());
  EXPECT_TRUE(used(one.data(), one.size()) == alone);
}

}  // namespace
}  // namespace paperbake
