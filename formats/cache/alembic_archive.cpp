#include "formats/cache/alembic_archive.h"

#include "formats/files/bytes_of.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace paperbake::alembic {
namespace {

constexpr std::int32_t file_version = 0;
constexpr std::int32_t library_version = 10800;  // the files have the layout of Alembic 1.8.0

bool operator!=(const Sample& a, const Sample& b) { return a.block != b.block; }

/// The number by which headers refer to a metadata text; 0 for an empty text.
std::uint32_t metadata_number(Archive& archive, const std::string& text) {
  if (text.empty()) return 0;
  auto known = std::find(archive.metadata.begin(), archive.metadata.end(), text);
  if (known == archive.metadata.end()) known = archive.metadata.insert(known, text);
  return static_cast<std::uint32_t>(known - archive.metadata.begin()) + 1;
}

/// first: the first sample that differs from sample 0; last: the last sample that differs from the
/// one before it. Both are 0 when all samples are equal.
struct Changes {
  std::size_t first = 0, last = 0;
};

Changes changes_of(const std::vector<Sample>& samples) {
  Changes changes;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (changes.first == 0 && samples[i] != samples[0]) changes.first = i;
    if (samples[i] != samples[i - 1]) changes.last = i;
  }
  return changes;
}

std::string header_of(const Property& property, std::uint32_t metadata) {
  const std::size_t count = property.samples.size();
  const Changes changes = changes_of(property.samples);
  const bool value = property.type != PropertyType::compound;
  const bool constant = changes.first == 0,
             partly = !constant && (changes.first > 1 || changes.last + 1 < count);

  const std::size_t largest = std::max(count, property.name.size());
  // each of the numbers below takes 2^width bytes
  const std::uint32_t width = largest <= 0xFF ? 0 : largest <= 0xFFFF ? 1 : 2;
  std::string numbers;
  const auto number = [&](std::size_t n) {
    numbers.append(bytes_of(std::uint64_t{n}).substr(0, std::size_t{1} << width));
  };

  std::uint32_t info = static_cast<std::uint32_t>(property.type) | width << 2 | metadata << 20;
  if (value) {
    const auto sampling = static_cast<std::uint32_t>(property.time_sampling);
    info |= static_cast<std::uint32_t>(property.pod) << 4 | property.extent << 12;
    info |= std::uint32_t{sampling != 0} << 8 | std::uint32_t{partly} << 9 |
            std::uint32_t{constant} << 11;
    number(count);
    if (partly) {
      number(changes.first);
      number(changes.last);
    }
    if (sampling != 0) number(sampling);
  }
  number(property.name.size());
  return std::string(bytes_of(info)) + numbers + property.name;
}

/// Writes the samples of a property and appends their keys to `content`.
OgawaBlock write_samples(Archive& archive, const Property& property, std::string& content) {
  const Changes changes = changes_of(property.samples);
  std::vector<OgawaBlock> children;
  for (std::size_t i = 0; i <= changes.last && i < property.samples.size(); ++i) {
    if (i > 0 && i < changes.first) continue;  // readers use sample 0 for these
    children.push_back(property.samples[i].block);
    // empty dimensions: readers take the count from the size
    if (property.type == PropertyType::array) children.push_back(empty_data);
    content += bytes_of_values(property.samples[i].key);
  }
  return archive.file.group(children);
}

/// Writes properties and appends the keys of their samples and their headers to `content`.
OgawaBlock write_compound(Archive& archive, const std::vector<Property>& properties,
                          std::string& content) {
  if (properties.empty()) return empty_group;
  std::vector<OgawaBlock> children;
  std::string headers;
  for (const Property& property : properties) {
    children.push_back(property.type == PropertyType::compound
                           ? write_compound(archive, property.members, content)
                           : write_samples(archive, property, content));
    headers += header_of(property, metadata_number(archive, property.metadata));
  }
  children.push_back(archive.file.data({headers}));
  content += headers;
  return archive.file.group(children);
}

struct WrittenObject {
  OgawaBlock block;
  // of the properties and of the children; programs treat objects with equal hashes as instances
  std::string hashes;
};

WrittenObject write_object(Archive& archive, const Object& object) {
  std::string content, names, children_content;
  std::vector<OgawaBlock> blocks{write_compound(archive, object.properties, content)};
  for (const Object& child : object.children) {
    const WrittenObject written = write_object(archive, child);
    blocks.push_back(written.block);
    children_content += child.name + child.metadata + written.hashes;
    names += bytes_of(static_cast<std::uint32_t>(child.name.size()));
    names += child.name;
    names += static_cast<char>(metadata_number(archive, child.metadata));
  }
  std::string hashes(bytes_of_values(content_hash(content)));
  hashes += bytes_of_values(content_hash(children_content));
  blocks.push_back(archive.file.data({names, hashes}));
  return {archive.file.group(blocks), hashes};
}

std::string time_sampling(std::size_t max_samples, double seconds_per_sample, double start) {
  std::string text(bytes_of(static_cast<std::uint32_t>(max_samples)));
  text += bytes_of(seconds_per_sample);
  text += bytes_of(std::uint32_t{1});  // number of stored times: the start
  text += bytes_of(start);
  return text;
}

}  // namespace

Sample store(Archive& archive, std::string_view bytes) {
  const ContentKey key = content_hash(bytes);
  if (bytes.empty()) return {empty_data, key};
  OgawaBlock& block = archive.stored[{key, bytes.size()}];
  if (block == 0) block = archive.file.data({bytes_of_values(key), bytes});
  return {block, key};
}

void truncate(Archive& archive, std::uint64_t end) {
  archive.file.truncate(end);
  archive.metadata.clear();
  for (auto it = archive.stored.begin(); it != archive.stored.end();)
    it = (it->second & ~empty_data) >= end ? archive.stored.erase(it) : std::next(it);
}

OgawaBlock write_tree(Archive& archive, const Object& root, const FrameTimes& times,
                      const std::string& metadata) {
  const OgawaBlock objects = write_object(archive, root).block;
  const std::string still = time_sampling(1, 1.0, 0.0),
                    sampling = time_sampling(times.count, times.step, times.start);
  std::string texts;
  for (const std::string& text : archive.metadata) {
    assert(text.size() <= 255 && archive.metadata.size() <= 254);
    texts += static_cast<char>(text.size());
    texts += text;
  }
  OgawaWriter& file = archive.file;
  const OgawaBlock outermost = file.group(
      {file.data({bytes_of(file_version)}), file.data({bytes_of(library_version)}), objects,
       file.data({metadata}), file.data({still, sampling}), file.data({texts})});
  file.flush();
  return outermost;
}

}  // namespace paperbake::alembic
