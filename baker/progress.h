#pragma once

#include <chrono>
#include <string>

namespace paperbake {

enum class ProgressMode { automatic, plain, json, none };

/// Tells on stderr how far a bake is: a bar on a terminal, plain lines otherwise, one JSON object a frame on demand.
class Progress {
 public:
  Progress(ProgressMode, int frames);
  ~Progress();

  /// frame  number of the frame just finished; c_m in percent
  void frame(const std::string& sheet, int frame, double stretch_mean_pct, int triangles, int singular);
  /// A sentence on a line of its own, whatever the mode (but none).
  void say(const std::string& sentence);

 private:
  enum class Style { bar, plain, json, none };

  Style style_;
  int frames_, done_ = 0;
  bool bar_open_ = false;
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace paperbake
