#pragma once

#include "baker/studies/first_point_experiment.h"
#include "formats/config/preset_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

/// Where the first singular points of measured sheets lie. The file: a line of names with u and v
/// among them, then a line a sheet, in metres on the sheet of the experiment.
/// returns  at least 3 points
/// throws   Error(ErrorCode::command) with file:line: no such file or column, no number, a point
///          beside the sheet, too few points
std::vector<Vector2d> read_scatter(const std::filesystem::path&);

struct Interval {
  double low, high;
  bool holds(double value) const { return low <= value && value <= high; }
};

/// Maximum likelihood of an even normal scatter about the law's mean + offset, with the intervals
/// that hold the truth in 95 of 100 samples: Student's t for the offset, chi squared for the
/// deviation, 2n - 2 degrees of freedom. likeliest deviation^2 = sum |p - mean|^2 / 2n; `deviation`
/// is that with n - 1 for n, without bias in the square
struct ScatterFit {
  int points;
  Vector2d offset;              // [m]
  Interval offset_u, offset_v;  // [m]
  double likeliest, deviation;  // [m]
  Interval deviation_within;    // [m]
};
ScatterFit fit_scatter(const std::vector<Vector2d>& points, const Vector2d& mean_of_law);

/// Are two samples of points from one distribution?
/// energy  2 E|a - b| - E|a - a'| - E|b - b'| [m]
/// p       [1] share of 999 random splits of the union (seeded) that are at least as far apart, the
///         given one counted
/// source  [Szekely, Rizzo 2004]
struct TwoSamples {
  double energy, p;
};
TwoSamples compare_samples(const std::vector<Vector2d>& a, const std::vector<Vector2d>& b);

/// The grade with the fitted scatter, under another name.
Preset with_scatter(Preset grade, const std::string& name, const ScatterFit&,
                    const std::string& measured);

/// As fig. 3 of [Schreck 2015]: crosses of measured sheets, dots of simulated ones, one and two
/// deviations about the mean. 700 x 760 px.
Image fit_picture(const Preset&, const std::vector<Vector2d>& measured,
                  const std::vector<Vector2d>& simulated, const ScatterFit&);

}  // namespace paperbake
