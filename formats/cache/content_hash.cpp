#include "formats/cache/content_hash.h"

#include <algorithm>
#include <cstring>

namespace paperbake {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "keys and files are little-endian; words are copied from memory");

constexpr std::uint64_t c1 = 0x87c37b91114253d5, c2 = 0x4cf5ad432745937f;

struct Words {
  std::uint64_t low, high;
};

Words words_at(const char* bytes) {
  Words words;
  std::memcpy(&words, bytes, sizeof words);
  return words;
}

std::uint64_t rotated(std::uint64_t word, int bits) { return word << bits | word >> (64 - bits); }

void mix_into(Words& h, const Words& block) {
  h.low ^= rotated(block.low * c1, 31) * c2;
  h.high ^= rotated(block.high * c2, 33) * c1;
}

/// Updates the state with a block of 16 bytes. The lower half is finished first because the upper
/// half depends on it.
void absorb_block(Words& h, const Words& block) {
  mix_into(h, block);
  h.low = (rotated(h.low, 27) + h.high) * 5 + 0x52dce729;
  h.high = (rotated(h.high, 31) + h.low) * 5 + 0x38495ab5;
}

std::uint64_t avalanche(std::uint64_t word) {
  word = (word ^ word >> 33) * 0xff51afd7ed558ccd;
  word = (word ^ word >> 33) * 0xc4ceb9fe1a85ec53;
  return word ^ word >> 33;
}

void add_halves(Words& h) {
  h.low += h.high;
  h.high += h.low;
}

}  // namespace

void ContentHasher::add(std::string_view bytes) {
  const std::size_t waiting = count_ % block;
  const std::size_t first = waiting == 0 ? 0 : std::min(block - waiting, bytes.size());
  bytes.copy(rest_ + waiting, first);
  count_ += bytes.size();
  Words h{low_, high_};
  if (first > 0 && waiting + first == block) absorb_block(h, words_at(rest_));
  std::size_t at = first;
  for (; at + block <= bytes.size(); at += block) absorb_block(h, words_at(bytes.data() + at));
  low_ = h.low;
  high_ = h.high;
  bytes.substr(at).copy(rest_, block);
}

ContentKey ContentHasher::key() const {
  Words h{low_, high_};
  char rest[block] = {};  // mixing in a zero word changes nothing, so the padding has no effect
  std::memcpy(rest, rest_, count_ % block);
  mix_into(h, words_at(rest));

  h.low ^= count_;
  h.high ^= count_;
  add_halves(h);
  h = {avalanche(h.low), avalanche(h.high)};
  add_halves(h);

  ContentKey key;
  std::memcpy(key.data(), &h, key.size());
  return key;
}

ContentKey content_hash(std::string_view bytes) {
  ContentHasher hasher;
  hasher.add(bytes);
  return hasher.key();
}

std::string hex(const ContentKey& key) {
  std::string text;
  for (const std::uint8_t byte : key) {
    text += "0123456789abcdef"[byte >> 4];
    text += "0123456789abcdef"[byte & 15];
  }
  return text;
}

}  // namespace paperbake
