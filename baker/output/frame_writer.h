#pragma once

#include "baker/job/plan.h"
#include "baker/output/bake_files.h"
#include "baker/output/gates.h"
#include "formats/cache/alembic_cache.h"
#include "formats/files/certificate.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// What a writer is made from.
struct WriterInput {
  const BakePlan& plan;
  std::filesystem::path folder;
};

/// What is known when all frames have been handed on.
struct FinishedFrames {
  std::vector<std::size_t> frames;           // of each sheet that should have been written
  const std::vector<HandleRecord>& handles;  // of all frames
};

/// How the bake ended.
struct BakeEnding {
  const std::vector<FrameRecord>& frames;  // frame by frame
  const std::vector<MissedGate>& missed;
  std::string failure;  // a sentence; empty: nothing failed
};

/// Writes the frames of a bake in one format. A writer that throws gets no further frames of that
/// file; the other writers go on.
class FrameWriter {
 public:
  virtual ~FrameWriter() = default;

  /// Name in the output folder of the file that the frames of this sheet go into.
  virtual std::string file(std::size_t sheet) const = 0;
  /// The frames that it shows, out of those that the bake writes.
  virtual FrameSpan frames_shown(const FrameSpan& written) const { return written; }
  /// Does it store CacheFrame::layers, the crease attributes?
  virtual bool stores_crease_attributes() const { return false; }
  /// Does it show pictures of the maps?
  virtual bool shows_maps() const { return false; }

  /// Appends the next frame of a sheet.
  /// returns  hash of the positions as they are in the file; empty if the format has none
  virtual std::string add_frame(std::size_t sheet, int frame, const CacheFrame&) = 0;
  /// Takes a picture of a map. png: bytes of a PNG file
  virtual void add_map(const std::string& /*caption*/, const std::string& /*png*/) {}

  /// Completes its files and lists those that there are.
  /// returns  how many frames of each sheet have the hash that add_frame returned; empty: none
  virtual std::vector<std::size_t> finish(const FinishedFrames&, BakeFiles&) = 0;
  /// Called after every writer has finished: for a file that tells how the bake ended.
  virtual void write_ending(const BakeEnding&, BakeFiles&) {}
};

/// Makes a writer.
/// throws  Error(ErrorCode::folder) when its file cannot be created
using MakeWriter = std::unique_ptr<FrameWriter> (*)(const WriterInput&);

/// How the writer of a format is made.
/// format   its name (baker/job/output_formats.h)
/// returns  null: it has no frames of meshes
MakeWriter maker_of_writer(const std::string& format);

}  // namespace paperbake
