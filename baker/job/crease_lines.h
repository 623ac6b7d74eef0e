#pragma once

#include "core/hands/expected_creases.h"
#include "formats/scene/scene_file.h"

#include <string>
#include <vector>

namespace paperbake {

/// A line of a sheet along which it is folded, and where it was learnt from.
struct CreaseLine {
  std::vector<Vector2d> line;  // [m] on the pattern
  // [rad] that it springs back to; of an expected crease: between the hands, in the frame in which
  // they turn most
  double angle;
  bool expected;       // by the keys of the handles; else the artist has drawn it
  std::string origin;  // "job", "edges marked in the mesh", the name of a node, clamps or a row
  // [m] how far a drawn one was moved at most, onto the line along which hands fold it
  double moved = 0;
};

/// The creases that the handles of a sheet are going to fold in a scene that begins at this frame.
std::vector<ExpectedCrease> expected_creases(const SceneSheet&, int first_frame);

/// The crease lines of a sheet: those that are drawn, in the order of the pattern, then the
/// expected ones. Line k is number k of Pattern::prescribed_creases in the plan of a bake; files
/// number the lines of each sheet from 1.
std::vector<CreaseLine> crease_lines(const SceneSheet&, const std::vector<ExpectedCrease>&);

/// A sentence for each drawn crease that was moved by more than handles on its line may be off:
/// somebody may have drawn it there on purpose.
std::vector<std::string> describe_moved(const std::string& sheet, double longer_side,
                                        const std::vector<CreaseLine>&);

/// One line for people, without indentation and end: number, ends, angle and origin.
std::string describe(const CreaseLine&, std::size_t number);

/// The expected lines among them as a value of job.lock.toml, in metres and degrees.
std::string toml_expected(const std::vector<CreaseLine>&);

}  // namespace paperbake
