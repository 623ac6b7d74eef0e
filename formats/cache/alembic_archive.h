#pragma once

#include "formats/cache/content_hash.h"
#include "formats/cache/ogawa.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// The generic layer of Alembic: an archive as a tree of objects and properties, and its layout in
/// an Ogawa file. Meshes are built on it in alembic_mesh.h.
namespace paperbake::alembic {

enum class PropertyType : std::uint32_t { compound = 0, scalar = 1, array = 2 };
enum class Pod : std::uint32_t {
  boolean = 0,
  u8 = 1,
  u32 = 5,
  i32 = 6,
  u64 = 7,
  f32 = 10,
  f64 = 11,
  text = 12
};
// index of a time sampling of the archive; identity is for values that do not change
enum class TimeSampling : std::uint32_t { identity = 0, frames = 1 };

/// A value in the file. Equal values share one block, so samples are equal if their blocks are.
struct Sample {
  OgawaBlock block;
  ContentKey key;
};

struct Property {
  std::string name, metadata;
  PropertyType type = PropertyType::compound;
  Pod pod = Pod::boolean;
  std::uint32_t extent = 0;  // numbers per element
  TimeSampling time_sampling = TimeSampling::identity;
  std::vector<Sample> samples;    // one for each frame
  std::vector<Property> members;  // of a compound
};

struct Object {
  std::string name, metadata;
  std::vector<Property> properties;
  std::vector<Object> children;
};

/// The times of TimeSampling::frames.
struct FrameTimes {
  std::size_t count = 0;
  double step = 0, start = 0;  // [s]
};

/// The file, and an index of what has been written to it.
struct Archive {
  explicit Archive(const std::filesystem::path& path) : file(path) {}

  OgawaWriter file;
  // every sample so far, by key and size [bytes]
  std::map<std::pair<ContentKey, std::size_t>, OgawaBlock> stored;
  // metadata texts, which headers refer to by their number from 1
  std::vector<std::string> metadata;
};

/// Stores a value in the file, unless the same bytes have been stored before for any property.
Sample store(Archive&, std::string_view bytes);

/// Restores the state that the file had when its end was there: samples stored since are dropped.
/// May be called after a write that failed.
void truncate(Archive&, std::uint64_t end);

/// Writes the tree over the samples that store() has written.
/// metadata  of the archive itself: key=value;key=value
/// returns   the outermost group, for OgawaWriter::commit
OgawaBlock write_tree(Archive&, const Object& root, const FrameTimes&, const std::string& metadata);

}  // namespace paperbake::alembic
