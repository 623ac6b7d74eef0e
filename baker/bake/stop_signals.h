#pragma once

#include <chrono>

namespace paperbake {

/// From its construction on, Ctrl-C (SIGINT) and SIGTERM end the program with exit code 5: the
/// first asks it to end by itself; when its patience is over or there is a second one, it is ended
/// on the spot, in whatever phase. Nothing is lost by that but the frame in progress, since files
/// appear complete or not at all, and frames that are done lie in checkpoints. Once in a program.
class StopSignals {
 public:
  explicit StopSignals(std::chrono::milliseconds patience);

  /// There was one.
  static bool asked();
};

}  // namespace paperbake
