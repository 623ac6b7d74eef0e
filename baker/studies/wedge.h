#pragma once

#include "baker/studies/wedge_axes.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// Many bakes of one scene that differ in what is varied, each a bake like any other in a folder of
/// its own: DIR/0001, DIR/0002, ... What each came to lies in DIR/.state, one file each, so that
/// processes on one machine or many can share the work.
struct Wedge {
  /// The settings that all have in common; output: DIR. Caches (abc) and certificates (cert) are
  /// always written, and a bake has one thread unless another number is said.
  Wedge(BakeSettings, std::vector<Axis>);

  int count() const { return variations(axes); }
  std::string name(int index) const;  // 0001
  std::filesystem::path folder(int index) const { return output / name(index); }
  std::filesystem::path state(int index, const char* ending) const;  // DIR/.state/0001ENDING
  BakeSettings settings(int index) const;

  BakeSettings common;
  std::vector<Axis> axes;
  std::filesystem::path output;
};

/// Bakes one variation, or finds that it was, as any bake in its folder does. Who comes while
/// another bakes it waits and finds it done. Warnings, progress and messages go to stderr.
/// stop     as that of a bake
/// returns  the exit code of the bake
/// throws Error(ErrorCode::command): there is no such variation; Error(ErrorCode::folder): DIR is
/// not writable; Error(ErrorCode::stopped)
int bake_variation(const Wedge&, int index, const std::function<bool()>& stop = {});

/// One line about a variation that came to an end: index, values, exit code or message.
std::string describe_variation(const Wedge&, int index);

/// Two JSON records (docs/progress.md): that a variation begins, and how it came to its end.
/// ended  how many have, with it
std::string variation_start(const Wedge&, int index);
std::string variation_end(const Wedge&, int index, int ended);

/// The names of the folders of variations that an earlier wedge has baked here and that are not
/// part of this one.
std::vector<std::string> folders_left(const Wedge&);

/// Forgets how a variation ended, before it is baked again.
void forget_end(const Wedge&, int index);

/// Notes the end of a process that was to bake a variation and could not tell itself.
void note_end(const Wedge&, int index, int exit_code);

struct WedgeOutcome {
  bool complete = false;  // every variation came to an end
  // 0: so did all; 4: gates were missed; else the largest of the others
  int exit_code = 0;
  std::vector<std::filesystem::path> files;  // wedge.csv, wedge.json, wedge.png
  std::string table;                         // as in wedge.csv, to be read on a terminal
};

/// When every variation came to an end: wedge.csv, wedge.json (index, values, exit code, mean
/// length error and worst edge of all frames, singular points, energy and crease length of the last
/// frame, key of the job, folder) and wedge.png, the last frame of each. Files that say so already
/// stay as they are. One process at a time. throws Error(ErrorCode::folder)
WedgeOutcome finish_wedge(const Wedge&);

}  // namespace paperbake
