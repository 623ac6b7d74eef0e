#include "formats/cache/crate_compression.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace paperbake::usd {
namespace {

/// Reads a block as the format defines it, and checks the rules for its end.
std::string unpacked(const std::string& block) {
  std::string bytes;
  std::size_t at = 0, last_match_at = 0, matches = 0;
  const auto byte = [&] { return static_cast<unsigned char>(block.at(at++)); };
  const auto length = [&](std::size_t four_bits) {
    if (four_bits < 15) return four_bits;
    for (unsigned more = 255; more == 255;) four_bits += more = byte();
    return four_bits;
  };
  for (;;) {
    const unsigned token = byte();
    const std::size_t literals = length(token >> 4);
    bytes += block.substr(at, literals);
    at += literals;
    if (at >= block.size()) {
      EXPECT_EQ(at, block.size());
      EXPECT_EQ(token & 15, 0u);
      if (matches > 0) {
        EXPECT_GE(literals, 5u);
        EXPECT_GE(bytes.size() - last_match_at, 12u);
      }
      return bytes;
    }
    std::size_t offset = byte();
    offset += std::size_t{byte()} << 8;
    if (offset == 0 || offset > bytes.size()) throw std::runtime_error("no such offset");
    last_match_at = bytes.size();
    ++matches;
    for (std::size_t left = length(token & 15) + 4; left > 0; --left)
      bytes += bytes[bytes.size() - offset];
  }
}

std::vector<std::uint32_t> unpacked_integers(const std::string& buffer, std::size_t count) {
  EXPECT_EQ(buffer.at(0), 0) << "more than one chunk";
  const std::string bytes = unpacked(buffer.substr(1));
  const auto number = [&](std::size_t at, std::size_t size) {
    std::int32_t value = bytes.at(at + size - 1) < 0 ? -1 : 0;  // the sign
    std::memcpy(&value, bytes.data() + at, size);
    return static_cast<std::uint32_t>(value);
  };
  std::vector<std::uint32_t> integers;
  std::uint32_t before = 0;
  std::size_t at = 4 + (count + 3) / 4;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned code = static_cast<unsigned char>(bytes.at(4 + i / 4)) >> i % 4 * 2 & 3;
    const std::size_t size = code == 0 ? 0 : std::size_t{1} << (code - 1);
    before += code == 0 ? number(0, 4) : number(at, size);
    at += size;
    integers.push_back(before);
  }
  EXPECT_EQ(at, bytes.size());
  return integers;
}

TEST(CrateCompression, ABlockOfLz4GivesTheBytesBackWhateverTheyAre) {
  std::mt19937 random(1);
  for (const unsigned different : {1u, 2u, 5u, 256u})
    for (const std::size_t size : {0, 1, 4, 5, 12, 13, 14, 17, 18, 300, 5000, 200000}) {
      std::string bytes;
      for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>(random() % different);
      EXPECT_EQ(unpacked(lz4_block(bytes)), bytes) << size << " bytes of " << different;
    }
}

TEST(CrateCompression, WhatRepeatsItselfTakesLittleRoomAndNoiseTakesNoMore) {
  std::string repeats, noise;
  std::mt19937 random(2);
  for (int i = 0; i < 100000; ++i) {
    repeats += "0123456789"[i % 10];
    noise += static_cast<char>(random());
  }
  EXPECT_LT(lz4_block(repeats).size(), 500u);
  EXPECT_LT(lz4_block(noise).size(), 100500u);
}

TEST(CrateCompression, IntegersOfEverySizeComeBack) {
  std::vector<std::uint32_t> integers{0, 1, 2, 3, 0xFFFFFFFF, 0, 0x80000000, 0x7FFFFFFF, 5, 133, 4};
  for (std::uint32_t i = 0; i < 1000; ++i) integers.push_back(i * i * 7919);
  EXPECT_EQ(unpacked_integers(compressed_integers(integers), integers.size()), integers);
}

TEST(CrateCompression, IntegersThatGrowByTheSameTakeTwoBitsBeforeTheyAreCompressed) {
  std::vector<std::uint32_t> integers;
  for (std::uint32_t i = 0; i < 4000; ++i) integers.push_back(3 * i);
  const std::string buffer = compressed_integers(integers);
  EXPECT_LT(buffer.size(), 50u);
  EXPECT_EQ(unpacked(buffer.substr(1)).size(), 4 + 1000 + 1);  // the first one grows by 0
  EXPECT_EQ(unpacked_integers(buffer, integers.size()), integers);
}

}  // namespace
}  // namespace paperbake::usd
