#pragma once

#include "core/animation/animate.h"
#include "formats/files/raster_image.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// The experiment of [Schreck 2015], fig. 3: a sheet of 100 x 100 mm, two opposite borders brought
/// closer by 10 %, then one of the other borders pushed at a right angle to the sheet until the
/// first singular point.
///
/// borders  u = 0, 100 mm: clamped, as fingers hold them, by two rows of handles 5 mm apart; closer
///          by 10 mm in frames 1-24
/// push     the middle of the border v = 0, a bare point, 20 mm down in 36 frames and on at that
///          pace to 40 mm (frame 96)
///
/// Hinged borders, a finger of 2 or 5 mm, and most meshes of 100-300 triangles let a conflict come
/// up elsewhere first, or none: the sheet can snap sideways at 12-15 mm, and a coarse mesh may have
/// no free vertex in the core. The mesh of 216 triangles that first_singular_point takes has its
/// first point in the core for both grades, elastic or plastic, at three paces of the push.
Shot first_point_experiment(const Paper&);
constexpr int experiment_frames = 96;
constexpr double experiment_side = 0.1;  // [m]

struct FirstPoint {
  Vector2d pattern;  // [m]
  unsigned seed;     // of the sheet
  int frame;         // of birth
};
/// One sheet of the experiment, by the hybrid on 216 triangles with plastic memory. Sheets differ
/// by the draw of the law.
/// returns  nothing when the sheet got no singular point
std::optional<FirstPoint> first_singular_point(const Paper&, unsigned seed);

/// Mean and deviation of a scatter, the latter over both directions about the mean.
struct Scatter {
  Vector2d mean{0, 0};   // [m]
  double deviation = 0;  // [m] 0 for less than two points
};
Scatter scatter_of(const std::vector<FirstPoint>&);

/// u,v,seed,frame   u, v in m
std::string scatter_csv(const std::vector<FirstPoint>&);

/// The sheet of the experiment with points on it, and circles of one and two deviations about a
/// mean. 700 x 760 px.
struct ScatterPicture {
  std::string title, caption;
  std::vector<Vector2d> crosses, dots;  // [m]
  Vector2d mean{0, 0};                  // [m]
  double deviation = 0;                 // [m]
};
Image draw_scatter(const ScatterPicture&);

/// What the experiment gave, about its mean with the deviation of the grade.
Image scatter_picture(const Paper&, const std::vector<FirstPoint>&);

/// The first singular points of sheets of a grade, with seeds from `first_seed` on; those that get
/// none are left out.
/// log  called with a sentence about each sheet
/// throws Error(ErrorCode::simulation) when no sheet gets one
std::vector<FirstPoint> push_sheets(const Paper&, int sheets, unsigned first_seed,
                                    const std::function<void(const std::string&)>& log);

}  // namespace paperbake
