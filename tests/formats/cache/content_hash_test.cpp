#include "formats/cache/content_hash.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace paperbake {
namespace {

TEST(ContentHash, GivesTheKeysThatAlembicWrites) {
  const std::int32_t three = 3;
  EXPECT_EQ(hex(content_hash({"\x01", 1})), "16fe7483905cce7a85670e43e4678877");
  EXPECT_EQ(hex(content_hash({reinterpret_cast<const char*>(&three), sizeof three})),
            "3ba1d27b7fde4848a86e865c6c402dfa");
}

TEST(ContentHash, DependsOnEveryByteOfBlocksAndRest) {
  // two whole blocks and 15 bytes
  const std::string text = "0123456789abcdef0123456789abcdef0123456789abcde";
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string other = text;
    other[i] ^= 1;
    EXPECT_NE(hex(content_hash(other)), hex(content_hash(text))) << "byte " << i;
  }
  // zero padding of the rest must not count as content
  EXPECT_NE(hex(content_hash(text + '\0')), hex(content_hash(text)));
}

TEST(ContentHash, IsTheSameOfBytesThatComeInParts) {
  const std::string text = "0123456789abcdef0123456789abcdef0123456789abcde";
  for (std::size_t first = 0; first <= text.size(); ++first)
    for (std::size_t second = first; second <= text.size(); ++second) {
      ContentHasher hasher;
      hasher.add(std::string_view(text).substr(0, first));
      hasher.add(std::string_view(text).substr(first, second - first));
      hasher.add(std::string_view(text).substr(second));
      ASSERT_EQ(hex(hasher.key()), hex(content_hash(text))) << first << " " << second;
    }
}

}  // namespace
}  // namespace paperbake
