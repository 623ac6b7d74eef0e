#pragma once

#include "baker/output/frame_writer.h"

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace paperbake {

/// The writers of the formats that a bake was asked for. One that fails ends there, and the others
/// go on; the frames that it has written are kept where its format allows it.
class CacheWriters {
 public:
  /// files  must outlive this
  /// throws Error(ErrorCode::folder) when a file cannot be created
  CacheWriters(const std::set<std::string>& formats, const WriterInput&, BakeFiles& files);

  bool empty() const { return writers_.empty(); }
  bool store_crease_attributes() const;
  bool show_maps() const;
  /// The frames that at least one file shows, out of those that the bake writes.
  FrameSpan frames_shown() const;

  /// Appends the next frame of a sheet to every file.
  /// returns  hash of its positions in the .abc; empty when they are not in it
  std::string add_frame(std::size_t sheet, int frame, const CacheFrame&);
  void add_map(const std::string& caption, const std::string& png);
  /// How many frames of each sheet were appended.
  const std::vector<std::size_t>& frames_added() const { return frames_added_; }

  /// Completes the files and lists them.
  /// returns  how many frames of each sheet are in the file whose hashes add_frame returned
  std::vector<std::size_t> finish(const FinishedFrames&);
  /// After finish: writes the files that tell how the bake ended.
  void write_ending(const BakeEnding&);

 private:
  FrameSpan frames_;
  BakeFiles& files_;
  std::vector<std::unique_ptr<FrameWriter>> writers_;
  std::vector<std::size_t> frames_added_;
};

}  // namespace paperbake
