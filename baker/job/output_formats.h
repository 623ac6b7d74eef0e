#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace paperbake {

class FrameWriter;
struct WriterInput;

/// Something that `--formats` can ask for.
struct OutputFormat {
  std::string name;  // as --formats has it
  std::string file;  // in the output folder; NAME stands for the stem of scene or job
  std::string what;  // a few words, for the help
  bool is_default;
  // it holds one mesh for the whole shot and cannot hold simulated meshes that change
  bool needs_one_mesh;
  // makes the writer of its frames (baker/output/frame_writer.h); null: it has no frames of meshes,
  // and the bake writes it itself
  std::unique_ptr<FrameWriter> (*make_writer)(const WriterInput&);

  /// Folder inside the output folder that its files lie in; empty: none.
  std::string folder() const {
    const std::size_t slash = file.find('/');
    return slash == std::string::npos ? "" : file.substr(0, slash);
  }
};

/// Every format, in the order of the help. The table stands in baker/output/output_formats.cpp,
/// beside the writers; options, defaults and the writers of a bake are read from it.
const std::vector<OutputFormat>& output_formats();

/// Names of the formats that are written unless --formats says otherwise.
std::set<std::string> default_formats();

/// Does one of these formats hold frames of meshes?
bool has_frames(const std::set<std::string>& formats);

}  // namespace paperbake
