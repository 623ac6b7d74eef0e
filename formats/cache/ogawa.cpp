#include "formats/cache/ogawa.h"

#include "formats/files/bytes_of.h"

#include <utility>

namespace paperbake {
namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "Ogawa is little-endian; numbers are copied from memory");

// format version 1, no root yet
constexpr std::string_view unfinished_head{"Ogawa\x00\x00\x01\0\0\0\0\0\0\0\0", 16};
// [bytes] positions in the head
constexpr std::uint64_t finished_at = 5, root_at = 8;

}  // namespace

OgawaWriter::OgawaWriter(std::filesystem::path path) : file_(std::move(path)) {
  append(unfinished_head);
}

OgawaBlock OgawaWriter::data(std::initializer_list<std::string_view> parts) {
  std::uint64_t size = 0;
  for (const std::string_view part : parts) size += part.size();
  if (size == 0) return empty_data;

  const OgawaBlock block = end_ | empty_data;
  append(bytes_of(size));
  for (const std::string_view part : parts) append(part);
  return block;
}

OgawaBlock OgawaWriter::group(const std::vector<OgawaBlock>& children) {
  if (children.empty()) return empty_group;
  const OgawaBlock block = end_;
  append(bytes_of(std::uint64_t{children.size()}));
  append(bytes_of_values(children));
  return block;
}

void OgawaWriter::truncate(std::uint64_t end) {
  file_.truncate(end);
  end_ = end;
}

void OgawaWriter::commit(OgawaBlock root) {
  file_.write_at(root_at, &root, sizeof root);
  file_.write_at(finished_at, "\xFF", 1);
  file_.commit();
}

void OgawaWriter::append(std::string_view bytes) {
  file_.write(bytes);
  end_ += bytes.size();
}

}  // namespace paperbake
