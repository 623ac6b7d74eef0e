#pragma once

#include "baker/bake/render_pass.h"
#include "baker/job/settings.h"

#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// The frames that a bake has rendered so far, in `.state/`, for one that goes on in the middle of
/// the render pass: each is kept as soon as it is there, and a bake that is complete removes them.
/// They are of use only to a bake that would render the same: to the key. Where the disk has little
/// room, nothing is kept.
class RenderedFrames {
 public:
  /// What is in the file under another key, or damaged, is dropped; with Resume::never all of it.
  RenderedFrames(std::filesystem::path file, std::string key, Resume);
  ~RenderedFrames();
  RenderedFrames(const RenderedFrames&) = delete;
  RenderedFrames& operator=(const RenderedFrames&) = delete;

  /// The next of the frames that an earlier bake has rendered: all sheets of it. Nothing: there are
  /// no more. To be called until then, before add().
  std::optional<std::vector<RenderedSheet>> take();
  /// Keeps a frame. Its numbers are in 32 bits already (round_to_32_bits).
  void add(const std::vector<RenderedSheet>&);

 private:
  void write(const std::string& bytes);
  void give_up();

  std::filesystem::path path_;
  std::FILE* file_ = nullptr;       // null: nothing is kept
  std::vector<CacheFrame> meshes_;  // of each sheet, as the file has them last
};

/// Rounds everything of a frame that moves to the 32 bits in which caches store it, so that it is
/// the same whether or not it was kept in between.
void round_to_32_bits(CacheFrame&);

/// Deletes what all bakes have kept in the folder `.state`.
void remove_rendered_frames(const std::filesystem::path& state_folder);

/// The name of such a file for a group of sheets. first: index of its first sheet
std::string rendered_frames_file(std::size_t first, MeshFeatures);

}  // namespace paperbake
