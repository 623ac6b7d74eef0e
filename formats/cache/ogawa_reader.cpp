#include "formats/cache/ogawa_reader.h"

#include "core/model/error.h"
#include "formats/files/atomic_file.h"

#include <array>
#include <utility>

namespace paperbake {
namespace {

constexpr std::uint64_t head_size = 16;
constexpr std::array<unsigned char, 8> finished_head{'O', 'g', 'a', 'w', 'a', 0xFF, 0, 1};

bool is_data(OgawaBlock block) { return (block & empty_data) != 0; }

}  // namespace

OgawaReader::OgawaReader(std::filesystem::path path) : path_(std::move(path)) {
  if (const std::string no_file = kind_of_no_file(path_); !no_file.empty())
    refuse("This is " + no_file + ", not a file.");
  file_.open(path_, std::ios::binary);
  if (!file_) refuse("There is no such file, or it cannot be read.");
  file_.seekg(0, std::ios::end);
  size_ = static_cast<std::uint64_t>(file_.tellg());
  std::array<unsigned char, 8> head{};
  if (size_ >= head_size) read(0, head.data(), head.size());
  if (head[0] == 'O' && head[5] == 0 && size_ >= head_size)
    refuse("The cache is unfinished: writing it was interrupted.");
  if (head != finished_head) refuse("This is not an Alembic (Ogawa) file.");
  read(8, &root_, sizeof root_);
}

std::string OgawaReader::data(OgawaBlock block) const {
  std::string bytes(data_size(block), '\0');
  if (!bytes.empty())
    read((block & ~empty_data) + sizeof(std::uint64_t), bytes.data(), bytes.size());
  return bytes;
}

std::uint64_t OgawaReader::data_size(OgawaBlock block) const {
  if (!is_data(block)) refuse("There is a group where data is expected.");
  return block == empty_data ? 0 : count_at(block & ~empty_data, 1);
}

std::vector<OgawaBlock> OgawaReader::group(OgawaBlock block) const {
  if (is_data(block)) refuse("There is data where a group is expected.");
  if (block == empty_group) return {};
  std::vector<OgawaBlock> children(count_at(block, sizeof(OgawaBlock)));
  if (!children.empty())
    read(block + sizeof(std::uint64_t), children.data(), children.size() * sizeof(OgawaBlock));
  return children;
}

/// The number of items, each of bytes_each bytes, in the block at this position. Refuses a number
/// of items that the rest of the file cannot hold.
std::uint64_t OgawaReader::count_at(std::uint64_t position, std::uint64_t bytes_each) const {
  std::uint64_t count = 0;
  if (position < head_size) refuse("A block lies in the head of the file.");
  read(position, &count, sizeof count);
  if (count > (size_ - position - sizeof count) / bytes_each)
    refuse("A block is longer than the file.");
  return count;
}

void OgawaReader::read(std::uint64_t position, void* bytes, std::uint64_t count) const {
  if (position > size_ || count > size_ - position)
    refuse("A block lies beyond the end of the file.");
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position));
  file_.read(static_cast<char*>(bytes), static_cast<std::streamsize>(count));
  if (!file_) refuse("The file cannot be read to its end.");
}

void OgawaReader::refuse(const std::string& cause) const {
  throw Error(ErrorCode::scene, path_.string(), cause, "Bake it again.");
}

}  // namespace paperbake
