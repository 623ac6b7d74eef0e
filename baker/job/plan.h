#pragma once

#include "baker/job/accuracy_choice.h"
#include "baker/job/attempt_choice.h"
#include "baker/job/crease_lines.h"
#include "baker/job/method_choice.h"
#include "baker/job/settings.h"
#include "core/animation/animate.h"
#include "core/hands/handle_feasibility.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// A pair of handles of a sheet that are farther apart than the paper between them is long.
struct UnreachablePairOfSheet {
  std::string sheet;
  UnreachablePair pair;
};

/// What is wrong with a sheet where it begins, and may be why it cannot follow later.
struct StartFault {
  std::vector<std::string> sheets;  // names of those that it is about
  std::string sentence;             // the beginning of one of BakePlan::warnings
};

/// Without --map-frames debug pictures are drawn of every 6th frame, of the last one, and of frames
/// with a new singular point.
constexpr int debug_picture_step = 6;

/// What is decided about a sheet, besides its shot.
struct PlannedSheet {
  unsigned seed = 0;
  std::string preset;                    // the name of its grade
  std::vector<CreaseLine> crease_lines;  // numbered as its Pattern::prescribed_creases
  // the part of its files' names that tells it from the others (file_names.h), such as ".SHEET";
  // empty for a single one
  std::string file_suffix;
  MethodChoice method;
  // of the sheet and those that it may touch: version, settings, paper, pattern, start shape,
  // handle points
  std::string start_hash;
};

/// Everything that a bake will do, decided before anything is simulated or written.
struct BakePlan {
  // stem of the scene or job file: the names of the output files begin with it
  std::string name;
  std::string root;                  // BakeSettings::root
  bool guides = false;               // BakeSettings::guides
  bool usd_layers = false;           // BakeSettings::usd_layers
  std::vector<Shot> shots;           // one a sheet
  std::vector<PlannedSheet> sheets;  // of each of them
  // simulated from the scene's first frame to the last one written
  AnimateOptions animation;
  std::string why_inertia;     // or why not
  FrameSpan frames;            // written
  bool ends_with_shot = true;  // they end no earlier than they would without --frames
  std::vector<FrameSpan> map_frames;
  // with a debug picture, besides the last and those with a new singular point
  std::vector<FrameSpan> debug_frames;
  // its name, followed by "+fem" when frames are polished
  std::string method;
  Polishing polish;
  // how the size of the mesh was chosen; none: it was given
  std::optional<AccuracyChoice> accuracy;
  std::optional<AttemptChoice> attempt;  // none: the first one is baked, and no other was tried
  std::vector<UnreachablePairOfSheet> impossible;
  std::vector<StartFault> start_faults;
  std::vector<std::string> warnings;
  std::vector<UsedValue> used;  // every value and where it came from, for job.lock.toml
  // of all sheets: as PlannedSheet::start_hash, without the values that only concern which frames
  // are written, and how
  std::string simulation_hash;
  // of the input of each frame of the scene by itself: keyed positions of the handles, which of
  // them hold, what hands press, poses of the colliders
  std::vector<std::string> frame_hash;
  // of the whole job: inputs of all sheets and frames, without threads, formats and paths
  std::string job_hash;
};

/// Reads the scene and decides every value. throws Error: unusable scene, unknown preset, unknown
/// method, contradicting options, and with `strict` handles that ask for more than paper can reach
BakePlan plan_bake(const BakeSettings&);

/// The same for a scene that has been read, or made in code.
BakePlan plan_bake(const BakeSettings&, Scene);

/// Whether a handle of a sheet is keyed beyond the reach of the paper in a frame.
bool is_out_of_reach(const BakePlan&, const std::string& sheet, const std::string& handle,
                     int frame);

/// The seed of a sheet: sheets of one seed differ.
unsigned seed_of_sheet(const BakePlan&, std::size_t sheet);

/// Options of each sheet of a plan.
std::vector<AnimateOptions> options_of_sheets(const BakePlan&);

/// Simulates the sheets of a plan with animate_together; if polish is planned, the frames that are
/// written and their neighbours are polished.
/// options        of each sheet
/// before_polish  as PolishOptions::on_simulated; not called where no polish is planned
void simulate(const BakePlan&, const std::vector<AnimateOptions>& options, int threads,
              const std::function<bool(const AnimatedFrame&)>& on_frame,
              const std::function<bool(const AnimatedFrame&)>& before_polish = {});

}  // namespace paperbake
