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

/// An Alembic archive as a tree of objects and properties, whatever they mean, and how it lies in
/// an Ogawa file.
namespace paperbake::alembic {

enum class PropertyType : std::uint32_t { compound = 0, scalar = 1, array = 2 };
enum class Pod : std::uint32_t { boolean = 0, u32 = 5, i32 = 6, f32 = 10, f64 = 11 };
// the time samplings of the archive, by number
enum class TimeSampling : std::uint32_t { identity = 0, frames = 1 };

/// A stored value. Equal values share one block of the file, so samples are equal when their blocks
/// are.
struct Sample {
  OgawaBlock block;
  ContentKey key;
};

struct Property {
  std::string name, metadata;
  PropertyType type = PropertyType::compound;
  Pod pod = Pod::boolean;
  std::uint32_t extent = 0;  // numbers in one element
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

/// The file, and what is known of it while it grows.
struct Archive {
  explicit Archive(const std::filesystem::path& path) : file(path) {}

  OgawaWriter file;
  // by key and size: every sample so far
  std::map<std::pair<ContentKey, std::size_t>, OgawaBlock> stored;
  // texts that headers refer to by number, from 1
  std::vector<std::string> metadata;
};

/// The bytes of an array or matrix, as it lies in memory; a view of `values`.
template <class Values>
std::string_view raw(const Values& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof *values.data()};
}

/// Puts a value into the file, unless the same bytes are there already, in whichever property.
Sample store(Archive&, std::string_view bytes);

/// The file again as it was when it ended there, also after a write that failed: samples stored
/// since are forgotten.
void truncate(Archive&, std::uint64_t end);

/// Writes all but the samples, which store() has put there. returns the outermost group, for
/// OgawaWriter::commit
/// metadata  of the archive itself: key=value;key=value
OgawaBlock write_tree(Archive&, const Object& root, const FrameTimes&, const std::string& metadata);

}  // namespace paperbake::alembic
