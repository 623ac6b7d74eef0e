#include "baker/output/preview.h"

#include "core/geometry/measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace paperbake {
namespace {

constexpr int max_panels = 16, width = 1300, gap = 8, title_height = 36, line_height = 16;  // [px]
constexpr double letter_dot = 1.6;                                                          // [px]
const Vector3d view(-0.6, -1.0, 0.75), to_light = Vector3d(-0.8, -0.15, 0.42).normalized(),
                                       to_sky = Vector3d(0.5, -0.5, 0.8).normalized();

constexpr Colour background{38, 40, 44}, panel_ground{58, 62, 68}, ink{20, 20, 20},
    letters{240, 240, 236}, held{10, 170, 70}, jammed{240, 130, 0};
// reflectance
const Vector3d paper_front(0.92, 0.90, 0.85), paper_back(0.70, 0.76, 0.86), solid(0.16, 0.20, 0.25);

std::uint8_t encoded(double linear) {
  return static_cast<std::uint8_t>(255 * std::pow(std::clamp(linear, 0.0, 1.0), 1 / 2.2) + 0.5);
}

/// A key light from the left, a weak one from the sky. normal: unit, at the viewer
Colour lit(const Vector3d& normal, const Vector3d& paper) {
  const double key = std::max(0.0, normal.dot(to_light)), sky = 0.5 * (1 + normal.dot(to_sky));
  const Vector3d colour = paper * (0.88 * key + 0.20 * sky * sky + 0.045);
  return {encoded(colour.x()), encoded(colour.y()), encoded(colour.z())};
}

std::vector<std::array<Colour, 3>> shading(const CacheFrame& frame, const Camera& camera) {
  const Points3 own =
      frame.normal.rows() > 0 ? Points3() : vertex_normals(frame.x, frame.triangles);
  const Points3& normals = frame.normal.rows() > 0 ? frame.normal : own;
  const Triangles& of_corner = frame.normal.rows() > 0 && frame.normal_of_corner.rows() > 0
                                   ? frame.normal_of_corner
                                   : frame.triangles;
  std::vector<std::array<Colour, 3>> corners(frame.triangles.rows());
  for (int t = 0; t < frame.triangles.rows(); ++t) {
    const Vector3d a = frame.x.row(frame.triangles(t, 0)), b = frame.x.row(frame.triangles(t, 1)),
                   c = frame.x.row(frame.triangles(t, 2));
    const bool front = (b - a).cross(c - a).dot(camera.towards) >= 0;
    for (int i = 0; i < 3; ++i) {
      const Vector3d normal = normals.row(of_corner(t, i));
      corners[t][i] = lit(front ? normal : Vector3d(-normal), front ? paper_front : paper_back);
    }
  }
  return corners;
}

/// All points that are ever shown. |V|x3 [m]
Points3 points_of(const std::vector<Panel>& panels) {
  Eigen::Index count = 0;
  for (const Panel& panel : panels)
    for (const CacheFrame& sheet : panel.sheets) count += sheet.x.rows();
  Points3 points(count, 3);
  Eigen::Index at = 0;
  for (const Panel& panel : panels)
    for (const CacheFrame& sheet : panel.sheets) {
      points.middleRows(at, sheet.x.rows()) = sheet.x;
      at += sheet.x.rows();
    }
  return points;
}

/// Fills what the paper has left free of the picture; before paper, by more than lies on it, a
/// veil.
/// picture  [px] whole ones
void draw_colliders(Canvas& canvas, const Camera& camera, const Viewport& picture,
                    const std::vector<PlacedCollider>& colliders) {
  constexpr double veil = 0.4, on_paper = 4;  // [1], [px]
  Canvas own(static_cast<int>(picture.width), static_cast<int>(picture.height), {}, canvas.samples);
  Camera moved = camera;
  moved.at -= Vector2d(picture.left, picture.top);
  for (const PlacedCollider& collider : colliders) {
    std::vector<Colour> faces;
    for (int t = 0; t < collider.triangles.rows(); ++t) {
      const Vector3d a = collider.x.row(collider.triangles(t, 0)),
                     b = collider.x.row(collider.triangles(t, 1)),
                     c = collider.x.row(collider.triangles(t, 2));
      const Vector3d normal = triangle_normal(a, b, c);
      faces.push_back(lit(normal.dot(camera.towards) >= 0 ? normal : Vector3d(-normal), solid));
    }
    draw_triangles(own, moved, collider.x, collider.triangles, faces);
  }
  constexpr float nothing = -std::numeric_limits<float>::infinity();
  const int n = canvas.samples;
  for (int row = 0; row < own.height * n; ++row)
    for (int column = 0; column < own.width * n; ++column) {
      const std::size_t k = std::size_t(row) * own.width * n + column;
      const std::size_t at = (std::size_t(picture.top) * n + row) * canvas.width * n +
                             std::size_t(picture.left) * n + column;
      if (own.depth[k] == nothing) continue;
      if (canvas.depth[at] == nothing) {
        canvas.colour[at] = own.colour[k];
        canvas.depth[at] = own.depth[k];
      } else if (own.depth[k] > canvas.depth[at] + on_paper / camera.scale)
        canvas.colour[at] = mix(canvas.colour[at], own.colour[k], veil);
    }
}

void draw_handle(Canvas& canvas, const Camera& camera, const HandleRecord& handle) {
  const Colour colour = handle.state == HandleFrame::jammed ? jammed : held;
  constexpr double radius = 2.2;
  const double lift = 2 * radius / camera.scale;
  draw_disc(canvas, camera, handle.held, radius + 0.8, ink, lift);
  draw_disc(canvas, camera, handle.held, radius, colour, lift);
  draw_disc(canvas, camera, handle.held, 0.9, colour, on_top);
}

}  // namespace

Image contact_sheet(const std::string& title, const std::vector<Panel>& panels) {
  const int count = std::max(1, static_cast<int>(panels.size()));
  const int columns = std::clamp(static_cast<int>(std::ceil(std::sqrt(count))), 1, 8),
            rows = (count + columns - 1) / columns;
  const int panel_width = (width - gap) / columns - gap;
  std::size_t lines = 0;
  for (const Panel& panel : panels) lines = std::max(lines, panel.caption.size());

  // as high as what is seen is beside its breadth
  const Points3 all = points_of(panels);
  Camera camera = fit_camera(all, view, {0, 0, 1, 1});
  Eigen::AlignedBox2d seen;
  for (Eigen::Index v = 0; v < all.rows(); ++v)
    seen.extend(Vector2d(camera.project(all.row(v)).head<2>()));
  const double shape =
      seen.isEmpty() || seen.sizes().x() <= 0 ? 0.75 : seen.sizes().y() / seen.sizes().x();
  const int caption_height = static_cast<int>(lines) * line_height + 8;
  const int picture_height =
      static_cast<int>(std::lround(panel_width * std::clamp(shape, 0.4, 1.0)));
  const int panel_height = caption_height + picture_height;
  camera = fit_camera(all, view, {12.0, 6, panel_width - 24.0, picture_height - 18.0});

  Canvas canvas(width, title_height + rows * (panel_height + gap), background);
  std::vector<Camera> cameras;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const double left = gap + (p % columns) * (panel_width + gap),
                 top = title_height + (p / columns) * (panel_height + gap);
    for (int row = 0; row < panel_height * canvas.samples; ++row) {
      const std::size_t at =
          (std::size_t(top) * canvas.samples + row) * canvas.width * canvas.samples +
          std::size_t(left) * canvas.samples;
      std::fill_n(canvas.colour.begin() + at, panel_width * canvas.samples, panel_ground);
    }
    cameras.push_back(camera);
    cameras.back().at += Vector2d(left, top + caption_height);
    for (const CacheFrame& sheet : panels[p].sheets)
      draw_smooth_triangles(canvas, cameras.back(), sheet.x, sheet.triangles,
                            shading(sheet, camera));
  }
  apply_ambient_occlusion(canvas, camera.scale, 0.04 * panel_width);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const double left = gap + (p % columns) * (panel_width + gap),
                 top = title_height + (p / columns) * (panel_height + gap);
    draw_colliders(canvas, cameras[p],
                   {left, top + caption_height, double(panel_width), double(picture_height)},
                   panels[p].colliders);
    for (const HandleRecord& handle : panels[p].handles) draw_handle(canvas, cameras[p], handle);
    for (std::size_t k = 0; k < panels[p].caption.size(); ++k)
      draw_text(canvas, left + 6, top + 6 + line_height * k, letter_dot, panels[p].caption[k],
                letters);
  }
  draw_text(canvas, gap, 10, 2, title, letters);
  return resolve_samples(canvas);
}

FrameSpan preview_frames(const FrameSpan& frames) {
  const int steps = (frames.last - frames.first) / frames.step,
            every = std::max(1, (steps + max_panels - 2) / (max_panels - 1));
  const int last = frames.first + steps * frames.step;
  return {last - steps / every * every * frames.step, last, every * frames.step};
}

void Preview::add_frame(int frame, const CacheFrame& cached) {
  if (!frames_.contains(frame)) return;
  auto at = std::lower_bound(shown_.begin(), shown_.end(), frame,
                             [](const PreviewFrame& s, int f) { return s.frame < f; });
  if (at == shown_.end() || at->frame != frame) at = shown_.insert(at, {frame, {}, {}});
  CacheFrame kept;
  kept.x = cached.x;
  kept.triangles = cached.triangles;
  kept.normal = cached.normal;
  kept.normal_of_corner = cached.normal_of_corner;
  at->sheets.push_back(std::move(kept));
}

void Preview::add_handles(const std::vector<HandleRecord>& handles) {
  for (const HandleRecord& handle : handles)
    for (PreviewFrame& shown : shown_)
      if (handle.frame == shown.frame && handle.state != HandleFrame::free)
        shown.handles.push_back(handle);
}

Image Preview::picture(const std::string& verdict) const {
  std::vector<Panel> panels;
  for (const PreviewFrame& shown : shown_) {
    Panel panel{{std::to_string(shown.frame)}, shown.sheets, shown.handles, {}};
    if (colliders_) {
      for (const auto& shape : shapes_at(*colliders_, shown.frame - first_frame_))
        panel.colliders.push_back({shape->mesh().x, shape->mesh().triangles});
    }
    panels.push_back(std::move(panel));
  }
  return contact_sheet(title_ + verdict, panels);
}

}  // namespace paperbake
