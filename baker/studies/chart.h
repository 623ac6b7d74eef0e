#pragma once

#include "baker/job/settings.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// Speed against accuracy, for one scene.
struct ChartSettings {
  // scene, paper, frames, seed as for a bake; method and sizes are the chart's
  BakeSettings job;
  std::vector<std::string> methods{"hybrid", "fem", "adaptive", "hybrid+fem"};
  int repeat = 3;        // [1] runs of each; times are medians
  int reference = 6000;  // [1] triangles of fem
  double budget = 600;   // [s] of the wall clock
};

/// One method at one size with one seed. Means over frames and sheets where nothing else is said;
/// CPU time on one thread.
struct ChartPoint {
  std::string method;
  // triangles of fem, also as it polishes; base triangles of hybrid, the most that adaptive may
  // have
  int size = 0;
  unsigned seed = 0;
  double triangles = 0;
  double elastic_ms = 0, geometry_ms = 0;  // a frame of all sheets
  double worst_frame_ms = 0;
  double c_m_pct = 0, max_stretch_pct = 0;  // mean; worst edge of any frame
  // from the reference, over 41 x 41 points, of the longer side
  double rms_pct = 0;
  double energy_rel = 0;                      // stored energy over that of the reference
  int not_converged = 0;                      // frames
  std::string failure;                        // why it did not finish; empty: it did
  double crease_length = 0, mean_crease = 0;  // [m] of the last frame
  int singular = 0;
  double total_ms() const { return elastic_ms + geometry_ms; }
};

struct Chart {
  std::string scene;               // name, frames, paper
  std::vector<ChartPoint> points;  // the reference first
  double reference_error_pct = 0;  // its own, by Richardson's extrapolation
  // from the reference to fem on another mesh of nearly as many triangles
  double control_pct = 0;
  bool chaotic = false;  // twins differ by more than methods do: distances mean nothing
  std::string machine;
  std::vector<std::string> remarks;
};

/// Runs every method at several sizes one after the other: first the reference (fem; half as many
/// triangles as long as it does not come to an end), fem on 1/2 ... 1/32 of its triangles and with
/// a loose stop, ten times farther from the minimum ("fem-loose"), the others (with three seeds
/// where there are singular points), a twin of the reference, then repeats, until the budget is
/// used up.
/// log  a sentence on what is being done
/// throws as plan_bake does; Error(ErrorCode::simulation) when no reference comes to an end
Chart chart(const ChartSettings&, const std::function<void(const std::string&)>& log);

/// Error of the finest of three results on n/4, n/2 and n triangles, from how far the coarser ones
/// are from it: with an error C n^-q each, near = C n^-q (2^q - 1), far = C n^-q (4^q - 1). q is
/// kept within [0.25, 2].
/// source  [Richardson 1911]
double richardson_error(double far, double near);

/// The points that no other one beats in both: from fast to exact, indices. Failed ones are no
/// rivals.
std::vector<int> pareto_front(const std::vector<ChartPoint>&);

/// method,size,seed,triangles,elastic_ms,geometry_ms,total_ms,worst_frame_ms,c_m_pct,max_stretch_pct,rms_pct,energy_rel,not_converged,failed
std::string chart_csv(const Chart&);

/// What remains to be compared where shapes do not:
/// method,size,seed,triangles,total_ms,c_m_pct,crease_length_m,mean_crease_m,singular,energy_rel
std::string statistics_csv(const Chart&);

}  // namespace paperbake
