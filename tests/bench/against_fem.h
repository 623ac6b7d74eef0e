#pragma once

#include "core/animation/animate.h"
#include "formats/scene/scene_file.h"

#include <string>
#include <vector>

namespace paperbake::bench {

/// A sample scene, up to the frame to which all methods agree on its shape.
enum class Ground { left_out, kept };
struct Case {
  const char* name;
  int last_frame;
  double gravity;
  Ground ground = Ground::left_out;  // whether the colliders of the scene are used
  const char* scene = name;
};
constexpr Case cases[] = {{"S1_push", 40, 0},
                          {"S2_moebius", 45, 0},
                          {"S5_roll", 72, 9.81},
                          {"S8_dcone", 44, 0},
                          {"S5_ground", 72, 9.81, Ground::kept, "S5_roll"}};

/// Means over the frames; worst_ms, edge and rise are the worst of all frames.
struct Numbers {
  double triangles = 0, elastic_ms = 0, geometry_ms = 0, worst_ms = 0, c_m = 0, edge = 0,
         iterations = 0, rise = 0;
  int singular = 0, accepted = 0, rejected = 0;
};
struct Run : Numbers {
  std::vector<Points3> frames, normals;  // at 41 x 41 points of the pattern
};

struct CaseShot {
  Shot shot;
  double fps;
};
CaseShot shot_of(const Case&);

/// Simulates a scene with a method: elastic paper, one thread.
Run run(const Shot&, const MethodChoice&, const Case&, double fps);

/// The same with fem. With BENCH_CACHE in the environment the run is read from that folder if it is
/// there, and stored there if it is not.
Run run_fem(const Shot&, int triangles, const Case&, double fps);

// RMS distance of the points, mean over the frames, in % of `side`
double rms_pct(const Run& a, const Run& b, double side);
// [degrees] angle between the normals, mean over points and frames
double normals_deg(const Run& a, const Run& b);

/// The scenes whose names begin with one of the words; without words all of them.
std::vector<Case> cases_named(const std::vector<std::string>& words);

}  // namespace paperbake::bench
