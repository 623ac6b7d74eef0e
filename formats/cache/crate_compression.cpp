#include "formats/cache/crate_compression.h"

#include "formats/files/bytes_of.h"

#include <algorithm>
#include <cstring>
#include <unordered_map>

namespace paperbake::usd {
namespace {

// of the LZ4 block format
constexpr std::size_t min_match = 4, max_offset = 65535;
constexpr std::size_t last_literals = 5;     // the block ends with so many bytes as they are
constexpr std::size_t last_match_from = 12;  // no match begins nearer to the end

std::uint32_t four_bytes(const char* at) {
  std::uint32_t value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// What of a length has no room in the four bits of the token.
void append_length(std::string& block, std::size_t length) {
  for (; length >= 255; length -= 255) block += static_cast<char>(255);
  block += static_cast<char>(length);
}

/// Literals, and a match unless length is 0.
void append_sequence(std::string& block, std::string_view literals, std::size_t offset,
                     std::size_t length) {
  const std::size_t more = length == 0 ? 0 : length - min_match;
  block += static_cast<char>(std::min<std::size_t>(literals.size(), 15) << 4 |
                             std::min<std::size_t>(more, 15));
  if (literals.size() >= 15) append_length(block, literals.size() - 15);
  block += literals;
  if (length == 0) return;
  block += static_cast<char>(offset & 255);
  block += static_cast<char>(offset >> 8);
  if (more >= 15) append_length(block, more - 15);
}

/// Of equally frequent ones, the largest.
std::int32_t most_frequent(const std::vector<std::int32_t>& values) {
  std::unordered_map<std::int32_t, std::size_t> count;
  for (const std::int32_t value : values) ++count[value];
  std::int32_t best = 0;
  std::size_t most = 0;
  for (const auto& [value, times] : count)
    if (times > most || (times == most && value > best)) {
      best = value;
      most = times;
    }
  return best;
}

}  // namespace

std::string lz4_block(std::string_view bytes) {
  constexpr unsigned table_bits = 14;
  std::vector<std::size_t> seen(std::size_t{1} << table_bits);  // position + 1 of such bytes
  std::string block;
  std::size_t at = 0, literals_from = 0;
  while (bytes.size() > last_match_from && at + last_match_from <= bytes.size()) {
    const std::uint32_t four = four_bytes(bytes.data() + at);
    std::size_t& place = seen[four * 2654435761u >> (32 - table_bits)];
    const std::size_t before = place;
    place = at + 1;
    if (before == 0 || at + 1 - before > max_offset ||
        four_bytes(bytes.data() + before - 1) != four) {
      // the longer nothing is found, the wider the steps: bytes that do not repeat cost little
      at += 1 + (at - literals_from) / 64;
      continue;
    }
    std::size_t length = min_match;
    while (at + length < bytes.size() - last_literals &&
           bytes[at + length] == bytes[before - 1 + length])
      ++length;
    append_sequence(block, bytes.substr(literals_from, at - literals_from), at + 1 - before,
                    length);
    at += length;
    literals_from = at;
  }
  append_sequence(block, bytes.substr(literals_from), 0, 0);
  return block;
}

std::string compressed(std::string_view bytes) { return '\0' + lz4_block(bytes); }

std::string compressed_integers(const std::vector<std::uint32_t>& integers) {
  if (integers.empty()) return {};
  std::vector<std::int32_t> differences;
  differences.reserve(integers.size());
  std::uint32_t before = 0;
  for (const std::uint32_t integer : integers) {
    differences.push_back(static_cast<std::int32_t>(integer - before));
    before = integer;
  }
  const std::int32_t common = most_frequent(differences);
  std::string codes((integers.size() + 3) / 4, '\0'), others;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const std::int32_t d = differences[i];
    unsigned code = 0;
    if (d == common) {
    } else if (d >= INT8_MIN && d <= INT8_MAX) {
      code = 1;
      others += bytes_of(static_cast<std::int8_t>(d));
    } else if (d >= INT16_MIN && d <= INT16_MAX) {
      code = 2;
      others += bytes_of(static_cast<std::int16_t>(d));
    } else {
      code = 3;
      others += bytes_of(d);
    }
    codes[i / 4] = static_cast<char>(static_cast<unsigned char>(codes[i / 4]) | code << i % 4 * 2);
  }
  std::string bytes;
  bytes += bytes_of(common);
  return compressed(bytes + codes + others);
}

}  // namespace paperbake::usd
