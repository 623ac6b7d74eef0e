#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

namespace paperbake {

/// Something that `--formats` can ask for.
struct OutputFormat {
  std::string name;  // as --formats has it
  std::string file;  // in the output folder; NAME stands for the stem of scene or job
  std::string what;  // a few words, for the help
  bool is_default;
  // frames of meshes, which a writer takes (baker/output/frame_writer.h); else the bake writes it
  // itself
  bool has_frames;
  // it holds one mesh for the whole shot and cannot hold simulated meshes that change
  bool needs_one_mesh;

  /// Folder inside the output folder that its files lie in; empty: none.
  std::string folder() const {
    const std::size_t slash = file.find('/');
    return slash == std::string::npos ? "" : file.substr(0, slash);
  }
};

/// Every format, in the order of the help. Options, defaults and the writers of a bake are read
/// from this table.
const std::vector<OutputFormat>& output_formats();

/// Names of the formats that are written unless --formats says otherwise.
std::set<std::string> default_formats();

/// Does one of these formats hold frames of meshes?
bool has_frames(const std::set<std::string>& formats);

}  // namespace paperbake
