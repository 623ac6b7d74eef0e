#pragma once

#include "baker/job/settings.h"
#include "formats/files/certificate.h"

#include <chrono>
#include <functional>
#include <map>
#include <string>

namespace paperbake {

/// What is done to every frame of a bake, one after the other: first all frames are simulated, then
/// they are rendered, that is, put on the mesh of the whole shot.
enum class Passes { simulate, simulate_and_render };

/// A frame that is done with a pass.
struct ProgressStep {
  std::string pass;  // "simulated" or "rendered"
  std::string sheet;
  int frame = 0;
  int done = 0, frames = 0;  // frames of all sheets that are done with this pass, and in all
};

/// Tells on stderr how far a bake is: a bar on a terminal, plain lines otherwise, one JSON object a
/// frame and pass on demand.
class Progress {
 public:
  /// frames  of all sheets
  Progress(ProgressMode, int frames, Passes);
  /// Tells these functions instead, and nothing on stderr; they may be empty.
  Progress(std::function<void(const ProgressStep&)> on_step,
           std::function<void(const std::string& sentence)> on_message, int frames, Passes);
  ~Progress();

  /// A frame is done with a pass. c_m: of the simulated mesh, then of the rendered one
  void simulated(const FrameRecord&);
  /// Frames of a sheet up to this one are not simulated but taken from an earlier bake: they are
  /// counted, and nothing is told of each.
  void taken(const std::string& sheet, int last_frame);
  void rendered(const FrameRecord&);
  /// A sentence on a line of its own, whatever the mode (but none).
  void message(const std::string& sentence);

 private:
  enum class Style { bar, plain, json, none };
  struct Pass {
    const char* name;
    int done = 0, taken = 0;  // taken: of them, from an earlier bake
    double seconds = 0;       // that its frames took
  };
  void frame(Pass&, const FrameRecord&, double stretch_mean, int triangles);
  double seconds_left() const;

  Style style_;
  std::function<void(const ProgressStep&)> on_step_;
  std::function<void(const std::string&)> on_message_;
  int frames_;
  Passes passes_;
  Pass simulate_{"simulated"}, render_{"rendered"};
  std::map<std::string, int> taken_;
  bool bar_open_ = false;
  std::chrono::steady_clock::time_point last_;  // when something was done
};

}  // namespace paperbake
