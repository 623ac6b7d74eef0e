#pragma once

#include "baker/bake/bake_context.h"
#include "baker/bake/bake_outcome.h"
#include "baker/bake/render_pass.h"
#include "baker/bake/sheet_recorder.h"
#include "baker/bake/stop_request.h"
#include "baker/bake/twin.h"
#include "baker/output/stale_files.h"
#include "core/model/error.h"

#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// The way of the frames of a bake, in three stages:
///
///   record  every simulated frame goes to the recorder of its sheet (sheet_recorder.h)
///   render  recorded frames are put on render meshes (render_pass.h) and go to the caches
///   write   caches, certificate and all other files are completed
///
/// A file that cannot be written is recorded as a failure; everything else goes on.
class BakePipeline {
 public:
  /// folder  the output folder, which is there
  /// throws  Error(ErrorCode::folder) when a file of a cache cannot be created
  BakePipeline(const BakeSettings&, const BakePlan&, const std::filesystem::path& folder, Progress&,
               StageClock&);
  ~BakePipeline();  // maps that are being drawn are completed
  BakePipeline(const BakePipeline&) = delete;
  BakePipeline& operator=(const BakePipeline&) = delete;

  /// Maps and crease attributes show what the paper keeps.
  bool needs_plastic_curvature() const;

  void record(const AnimatedFrame&);
  /// What was recorded is not baked: the maps and pictures of it are removed. Nothing must follow.
  void discard();
  /// The last frame that was recorded; if there is none, one before any.
  int recorded_until() const { return recorded_until_; }
  /// A frame of the twin, after all frames were recorded; with BakeSettings::twin.
  void record_twin(const AnimatedFrame&);
  std::optional<TwinVerdict> twin() const { return twin_verdict(certificate_.frames()); }
  /// stop  when its time is up, the frames that are not rendered yet are left out
  /// returns  whether all were rendered
  bool render(StopRequest& stop);
  /// After a failure, caches of the same bake that are there already and have more frames stay, and
  /// with them all files that belong to them.
  /// failure  what ended the simulation
  /// key      of the bake (bake_key)
  /// throws   when something failed: that, or the first file that could not be written; with what
  ///          is kept all the same
  BakeOutcome write(const std::optional<Error>& failure, const std::string& key);

  BakeFiles& files() { return files_; }
  StageClock& clock() { return *context_.clock; }
  /// Of what was simulated, a later bake finds no frame after this one.
  void note_kept_until(int frame) { kept_until_ = frame; }
  /// No frame was recorded that is to be written.
  bool is_empty() const { return certificate_.frames().empty(); }

 private:
  void render_group(const std::vector<std::size_t>& sheets, StopRequest&);
  void render_frames(const std::vector<std::size_t>& sheets, MeshFeatures, int& rendered,
                     StopRequest&);
  void hand_on(const std::vector<std::size_t>& sheets, std::vector<RenderedSheet>&);
  std::string render_key(const std::vector<std::size_t>& sheets) const;
  [[noreturn]] void leave_longer_caches(const Error& failure);
  void list_outputs(StaleFiles);
  void write_certificate(const BakeOutcome&, const std::optional<Error>& failure);
  std::optional<Error> final_error(const std::optional<Error>& failure) const;

  BakeFiles files_;
  BakeCertificate certificate_;
  CacheWriters caches_;
  TaskQueue tasks_;
  BakeContext context_;
  std::vector<std::unique_ptr<SheetRecorder>> recorders_;
  int kept_until_ = std::numeric_limits<int>::max();  // of what is simulated
  int recorded_until_ = std::numeric_limits<int>::min();
  std::map<std::filesystem::path, std::string> keys_;  // of files that are in the certificate
  std::optional<SampledShapes> shapes_;                // for the twin
};

}  // namespace paperbake
