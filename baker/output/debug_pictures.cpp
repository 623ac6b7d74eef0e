#include "baker/output/debug_pictures.h"

#include "core/geometry/curvature.h"
#include "core/geometry/measure.h"
#include "core/geometry/point_location.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace paperbake {
namespace {

constexpr int width = 1600, height = 860;  // [px]
constexpr Viewport left_panel{40, 100, 690, 680}, right_panel{820, 100, 740, 680};
// [1/m] below it no ruling is drawn
constexpr double flat = 3;
const Vector3d view(-0.6, -1.0, 0.7), to_light = Vector3d(-0.75, -0.25, 0.6).normalized();

constexpr Colour background{246, 246, 246}, ink{40, 40, 40}, faint{150, 150, 150},
    outward{214, 40, 30}, inward{30, 80, 200}, level{255, 255, 255}, mesh_line{120, 120, 120},
    ruling_line{0, 0, 0}, stroke{20, 90, 30}, paper_front{255, 252, 244}, paper_back{190, 200, 214},
    facet_line{70, 70, 70}, held{10, 150, 60}, jammed{240, 130, 0}, released{150, 150, 150},
    apex{200, 0, 170};

/// Small curvatures are told apart too: the colour grows with the root.
Colour curvature_colour(double k, double full) {
  return mix(level, k > 0 ? outward : inward, std::sqrt(std::abs(k) / full));
}

/// Hues a golden angle apart.
Colour region_colour(int region) {
  const double turn = 2 * M_PI * 0.381966 * region;
  const auto channel = [&](double at) {
    return static_cast<std::uint8_t>(std::lround(150 + 90 * std::cos(turn - at)));
  };
  return {channel(0), channel(2 * M_PI / 3), channel(4 * M_PI / 3)};
}

Colour handle_colour(HandleFrame::State state) {
  switch (state) {
    case HandleFrame::free:
      return released;
    case HandleFrame::jammed:
      return jammed;
    default:
      return held;
  }
}

Vector3d on_pattern(const Vector2d& p) { return {p.x(), p.y(), 0}; }

void draw_dot(Canvas& canvas, const Camera& camera, const Vector3d& p, double radius, Colour colour,
              double lift = on_top) {
  draw_disc(canvas, camera, p, radius + 1, ink, lift);
  draw_disc(canvas, camera, p, radius, colour, lift);
}

/// Small where the sheet hides it.
void draw_dot_on_sheet(Canvas& canvas, const Camera& camera, const Vector3d& p, double radius,
                       Colour colour) {
  draw_dot(canvas, camera, p, radius, colour, 2 * radius / camera.scale);
  draw_disc(canvas, camera, p, 2, colour, on_top);
}

/// On white, on the upper right of a dot.
void draw_number(Canvas& canvas, const Camera& camera, const Vector3d& p, std::size_t number) {
  const Vector3d q = camera.project(p);
  const std::string text = std::to_string(number);
  draw_rectangle(canvas, {q.x() + 6, q.y() - 19, text_width(text, 1.6) + 4, 15}, level);
  draw_text(canvas, q.x() + 8, q.y() - 17, 1.6, text, apex);
}

/// A length of 1, 2 or 5 times a power of ten, about 100 px long.
void draw_scale_bar(Canvas& canvas, const Camera& camera, double left, double top) {
  const double wanted = 120 / camera.scale, decade = std::pow(10, std::floor(std::log10(wanted)));
  const double length = wanted >= 5 * decade   ? 5 * decade
                        : wanted >= 2 * decade ? 2 * decade
                                               : decade;
  draw_rectangle(canvas, {left, top, length * camera.scale, 4}, ink);
  draw_text(canvas, left, top + 9, 1.6, fmt::format("{:g} mm", 1e3 * length), ink);
}

void draw_legend(Canvas& canvas, double full, double left, double top) {
  constexpr int steps = 100;
  constexpr double long_side = 220;
  for (int k = 0; k < steps; ++k) {
    const double curvature = full * (2 * (k + 0.5) / steps - 1);
    draw_rectangle(canvas, {left + long_side * k / steps, top, long_side / steps, 12},
                   curvature_colour(curvature, full));
  }
  const std::string low = fmt::format("{:.0f}", -full), high = fmt::format("+{:.0f} 1/m", full);
  draw_text(canvas, left, top + 17, 1.6, low, ink);
  draw_text(canvas, left + 0.5 * long_side - 4, top + 17, 1.6, "0", ink);
  draw_text(canvas, left + long_side - 32, top + 17, 1.6, high, ink);
  draw_text(canvas, left - 32, top + 1, 1.6, "k1", ink);
}

void draw_pattern(Canvas& canvas, const Shot& shot, const AnimatedFrame& frame) {
  const Sheet& sheet = *frame.sheet;
  const Camera camera = fit_camera(sheet.pattern, left_panel);
  const Points3 curvature = vertex_curvature(sheet);
  const double full = yield_curvature(shot.paper);

  std::vector<Colour> face(sheet.triangles.rows());
  for (int t = 0; t < sheet.triangles.rows(); ++t) {
    const Vector3d mean =
        (curvature.row(sheet.triangles(t, 0)) + curvature.row(sheet.triangles(t, 1)) +
         curvature.row(sheet.triangles(t, 2))) /
        3;
    face[t] = curvature_colour(principal_curvature(mean).k1, full);
    if (!frame.parts.region.empty() && frame.parts.region[t] >= 0)
      face[t] = mix(face[t], region_colour(frame.parts.region[t]), 0.5);
  }
  Points3 flat_x = Points3::Zero(sheet.pattern.rows(), 3);
  flat_x.leftCols<2>() = sheet.pattern;
  draw_triangles(canvas, camera, flat_x, sheet.triangles, face);
  const double edge = mean_edge(sheet.pattern, sheet.triangles),
               fine = std::min(1.0, 0.06 * edge * camera.scale);
  draw_edges(canvas, camera, flat_x, sheet.triangles, {fine, mesh_line});

  const double reach = 0.17 * edge;
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const Principal p = principal_curvature(curvature.row(v));
    if (std::abs(p.k1) <= flat) continue;
    const Vector2d at = sheet.pattern.row(v), along(-p.across.y(), p.across.x());
    draw_line(canvas, camera, on_pattern(at - reach * along), on_pattern(at + reach * along),
              {1.8 * fine, stroke});
  }
  for (const auto& [from, to] : frame.parts.rulings)
    draw_line(canvas, camera, on_pattern(from), on_pattern(to), {2, ruling_line});

  for (std::size_t h = 0; h < shot.handles.size(); ++h) {
    const Vector2d& at = shot.handles[h].pattern;
    const std::vector<Vector2d> rim =
        disc_rim(shot.pattern, at, disc_radius(shot.handles, h, shot.pattern));
    for (const Vector2d& p : rim) draw_disc(canvas, camera, on_pattern(p), 2, ink);
    draw_dot(canvas, camera, on_pattern(at), 3.5, handle_colour(frame.handles[h].state));
  }
  for (std::size_t k = 0; k < sheet.singular.size(); ++k) {
    draw_dot(canvas, camera, on_pattern(sheet.singular[k].pattern), 4.5, apex);
    draw_number(canvas, camera, on_pattern(sheet.singular[k].pattern), k + 1);
  }
  draw_legend(canvas, full, left_panel.left + 40, 812);
  draw_scale_bar(canvas, camera, left_panel.left + 460, 816);
}

void draw_sheet(Canvas& canvas, const AnimatedFrame& frame) {
  const Sheet& sheet = *frame.sheet;
  const Camera camera = fit_camera(sheet.x, view, right_panel);
  const double pixel = 1 / camera.scale;  // [m]
  draw_triangles(canvas, camera, sheet.x, sheet.triangles,
                 flat_shading(sheet.x, sheet.triangles, camera, to_light, paper_front, paper_back));
  const double fine =
      std::min(1.0, 0.06 * mean_edge(sheet.pattern, sheet.triangles) * camera.scale);
  draw_edges(canvas, camera, sheet.x, sheet.triangles, {0.8 * fine, facet_line, 1.5 * pixel});
  for (const HandleFrame& handle : frame.handles)
    draw_dot_on_sheet(canvas, camera, handle.at, handle.state == HandleFrame::free ? 2.5 : 4,
                      handle_colour(handle.state));
  if (!sheet.singular.empty()) {
    const PointLocator locator(sheet.pattern, sheet.triangles);
    for (std::size_t k = 0; k < sheet.singular.size(); ++k) {
      const Vector3d at =
          interpolate(locator.locate(sheet.singular[k].pattern), sheet.triangles, sheet.x);
      draw_dot_on_sheet(canvas, camera, at, 4.5, apex);
      draw_number(canvas, camera, at, k + 1);
    }
  }
  draw_scale_bar(canvas, camera, right_panel.left, 816);
}

void draw_captions(Canvas& canvas, const AnimatedFrame& frame, const std::string& title) {
  const LengthDistortion length = length_distortion(*frame.sheet);
  draw_text(canvas, 40, 18, 2.5, title, ink);
  draw_text(
      canvas, 40, 48, 1.6,
      fmt::format("{} triangles, {} singular points ({} new), c_m {:.3g} %, worst edge {:.2g} % at "
                  "({:.1f}, {:.1f}) mm, energy {:.4g} mJ, {} Newton steps{}{}",
                  frame.sheet->triangles.rows(), frame.sheet->singular.size(),
                  frame.statistics.new_singular, 100 * length.mean, 100 * length.largest,
                  1e3 * length.where.x(), 1e3 * length.where.y(), 1e3 * frame.statistics.energy,
                  frame.statistics.newton_iterations,
                  frame.statistics.substeps > 1
                      ? fmt::format(" in {} substeps", frame.statistics.substeps)
                      : "",
                  frame.statistics.converged ? "" : ", not converged"),
      ink);
  draw_text(canvas, 40, 66, 1.6, frame.note, faint);
}

}  // namespace

Image debug_picture(const Shot& shot, const AnimatedFrame& frame, const std::string& title) {
  Canvas canvas(width, height, background);
  draw_pattern(canvas, shot, frame);
  draw_sheet(canvas, frame);
  draw_captions(canvas, frame, title);
  return resolve_samples(canvas);
}

}  // namespace paperbake
