#pragma once

#include "baker/job/settings.h"
#include "formats/files/certificate.h"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

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

/// What a bake is about to do.
struct ProgressStart {
  std::string name, job_hash;
  FrameSpan frames;
  std::vector<std::string> sheets;
  std::filesystem::path output;
};

/// How a bake ended.
struct ProgressEnd {
  int exit_code = 0;
  std::vector<std::string> gates_missed;
  std::vector<std::filesystem::path> files;
  std::string error;  // place, cause and remedy, each on a line of its own; empty: none
};

/// Tells on stderr how far a bake is: a bar on a terminal, plain lines otherwise, on demand JSON
/// objects (docs/progress.md), or nothing but the reason of an exit code 4; and all of it to a log
/// file, if there is one.
class Progress {
 public:
  /// frames  of all sheets
  Progress(ProgressMode, int frames, Passes);
  /// Tells these functions instead, and nothing on stderr; they may be empty.
  Progress(std::function<void(const ProgressStep&)> on_step,
           std::function<void(const std::string& sentence)> on_message, int frames, Passes);
  ~Progress();

  /// Appends every line from now on to this file too, with the time of day in UTC before it.
  /// throws Error(ErrorCode::folder) when it cannot be opened
  void log_to(const std::filesystem::path&);

  void start(const ProgressStart&);
  /// A frame is done with a pass. The stretch is that of the simulated mesh, then of the rendered
  /// one.
  void simulated(const FrameRecord&);
  /// Frames of a sheet up to this one are not simulated but taken from an earlier bake: they are
  /// counted, and nothing is told of each.
  void taken(const std::string& sheet, int last_frame);
  /// What was simulated is not used: the first pass begins again.
  void begin_again();
  /// The second pass has so many frames of all sheets. To be called where they are not those of the
  /// first, before one is rendered.
  void expect_rendered(int frames) { render_.frames = frames; }
  void rendered(const FrameRecord&);
  /// A sentence on a line of its own, whatever the mode (but none).
  void message(const std::string& sentence) { say("message", "", sentence); }
  void warning(const std::string& sentence) { say("warning", "warning: ", sentence); }
  void gate_missed(const std::string& sentence) { say("gate", "gate missed: ", sentence); }
  void end(const ProgressEnd&);
  /// Ends what is told of the bake that is under way, for a program that is about to end in the
  /// middle of it. May be called from another thread.
  /// returns  false: none is under way
  static bool end_abruptly(const Error&);

 private:
  enum class Style { bar, plain, json, none, functions };
  struct Pass {
    const char* name;
    int frames;               // of all sheets
    int done = 0, taken = 0;  // taken: of them, from an earlier bake
    double seconds = 0;       // that its frames took
    double first = 0;         // [s] of these for the first one, with which more is prepared
  };
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void say(const char* type, const char* prefix, const std::string& sentence);
  void frame(Pass&, const FrameRecord&, double stretch_mean, int triangles);
  /// "simulated frame 4 of 72, 0:12 left, stretched 0.003 %, 1 sharp point"
  std::string frame_text(const Pass&, const FrameRecord&, double stretch_mean) const;
  void log(const std::string& line);
  void tell_end(const ProgressEnd&);
  double seconds_left() const;

  Style style_;
  std::function<void(const ProgressStep&)> on_step_;
  std::function<void(const std::string&)> on_message_;
  Passes passes_;
  bool several_sheets_ = false;
  Pass simulate_, render_;
  std::map<std::string, int> taken_;
  bool bar_open_ = false;
  std::atomic<bool> ended_ = false;  // by whichever thread; nothing is told any more
  std::chrono::steady_clock::time_point begun_, last_;  // last_: when something was done
  std::unique_ptr<std::FILE, CloseFile> log_;
};

}  // namespace paperbake
