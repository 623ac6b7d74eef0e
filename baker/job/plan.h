#pragma once

#include "baker/job/settings.h"
#include "core/animation/animate.h"
#include "core/animation/handle_feasibility.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// A pair of handles that asks the impossible, and of which sheet.
struct SheetImpossible {
  std::string sheet;
  ImpossiblePair pair;
};

inline constexpr const char* hybrid_and_fem = "hybrid+fem";  // hybrid, polished

/// What --method may say, and the whole list in words.
bool is_method(const std::string&);
inline constexpr const char* all_methods = "hybrid, fem, adaptive, hybrid+fem";

/// Are frames finished by a fine fem (core/animation/refined_animation.h)?
struct Polishing {
  int triangles = 0;  // 0: they are not
  std::string why;
};

/// The frames of which a bake draws such a picture when none are named: every 6th, the last, and
/// every frame with a birth.
constexpr int debug_picture_step = 6;

/// All that a bake will do, decided before anything is simulated or written.
struct BakePlan {
  // stem of the scene file: begins the names of the output files
  std::string name;
  std::vector<Shot> shots;           // one a sheet
  std::vector<unsigned> seeds;       // of each sheet
  std::vector<std::string> presets;  // of each sheet
  // simulated from the scene's first frame to the last one written
  AnimateOptions animation;
  std::string why_inertia;  // or why not
  FrameSpan frames;         // written
  std::vector<FrameSpan> map_frames;
  // with a debug picture, besides the last and those with a birth
  std::vector<FrameSpan> debug_frames;
  // as it is called: with "+fem" behind it when frames are polished
  std::string method;
  std::vector<MethodChoice> methods;  // of each sheet
  Polishing polish;
  std::vector<SheetImpossible> impossible;
  std::vector<std::string> warnings;
  std::vector<UsedValue> used;  // every value and where it came from, for job.lock.toml
  // of each sheet, and of those it may touch: version, settings, paper, pattern, start shape,
  // handle points
  std::vector<std::string> start_hash;
  // of all sheets: what of that the simulation depends on; nothing of frames written and how
  std::string simulation_hash;
  // over the whole job: input of all sheets and frames; no threads, formats or paths
  std::string job_hash;
};

/// Reads the scene and settles every value. throws Error: scene unusable, unknown preset, unknown
/// method, and with `strict` handles that ask the impossible
BakePlan plan_bake(const BakeSettings&);

/// The same for a scene that has been read, or made in code.
BakePlan plan_bake(const BakeSettings&, Scene);

/// What each sheet of a plan is animated with.
std::vector<AnimateOptions> options_of_sheets(const BakePlan&);

/// Simulates the sheets of a plan: animate_together, polished where that is planned, for the frames
/// that are written and their neighbours.
/// options  of each sheet
void simulate(const BakePlan&, const std::vector<AnimateOptions>& options, int threads,
              const std::function<bool(const AnimatedFrame&)>& on_frame);

/// One sentence about such a pair: frames, names, overshoot.
std::string describe(const SheetImpossible&);

/// Hash of what frame `frame` of sheets that may touch depends on beyond `before`, the hash of the
/// frame before it: keys and grips.
std::string frame_input_hash(const std::string& before, const std::vector<Shot>&, int frame,
                             int first_frame);

/// job.lock.toml.
std::string lock_text(const BakePlan&);

}  // namespace paperbake
