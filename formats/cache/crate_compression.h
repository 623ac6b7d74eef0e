#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// How a USD crate file packs what repeats itself. Written here, because another version of a
/// library may find other matches, and the same cache would have other bytes.
namespace paperbake::usd {

/// The bytes as one LZ4 block, greedily: the first match that a table of hashes of four bytes
/// finds. At most 2,113,929,216 bytes.
/// source  LZ4 block format, https://github.com/lz4/lz4/blob/dev/doc/lz4_Block_format.md
std::string lz4_block(std::string_view bytes);

/// A buffer as crate files have it: the number of chunks, 0 for one block of LZ4, then the block.
std::string compressed(std::string_view bytes);

/// 32-bit integers, signed or not: the differences from one to the next, of which the most frequent
/// takes two bits and the others two bits and as few bytes as hold them; then compressed.
///
///   most frequent difference (4 bytes), 2 bits an integer (0: that one; 1, 2, 3: of 1, 2, 4
///   bytes), the other differences one after another
std::string compressed_integers(const std::vector<std::uint32_t>&);

}  // namespace paperbake::usd
