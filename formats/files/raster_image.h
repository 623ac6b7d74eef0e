#pragma once

#include "core/model/sheet.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace paperbake {

struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;  // sRGB
  bool operator==(const Colour& o) const {
    return red == o.red && green == o.green && blue == o.blue;
  }
};
/// a (1-t) + b t, t in [0, 1].
Colour mix(Colour a, Colour b, double t);

struct Image {
  int width = 0, height = 0;   // [px]
  std::vector<Colour> pixels;  // row by row from the top left
  const Colour& at(int column, int row) const { return pixels[std::size_t(row) * width + column]; }
};

/// The bytes of a PNG file, 8 bits; the same for the same picture.
std::string png_bytes(const Image&);

/// As PNG, 8 bits, whole or not at all; the same bytes for the same picture. throws
/// Error(Fault::folder)
void write_png(const std::filesystem::path&, const Image&);

/// A parallel projection into the picture. Columns run to the right and rows downwards.
struct Camera {
  // [m]    point of the world that is seen ...
  Vector3d centre{0, 0, 0};
  Vector2d at{0, 0};                                       // [px]   ... here
  Vector3d right{1, 0, 0}, up{0, 1, 0}, towards{0, 0, 1};  // unit, towards: at the viewer
  double scale = 1;                                        // [px/m]

  /// Column and row [px], and how near it is [m]: the larger, the nearer.
  Vector3d project(const Vector3d& p) const;
};

struct Viewport {
  double left, top, width, height;  // [px] part of a picture
};
/// Sees all points from the side `from`, as large as the frame allows; z points up, or y where one
/// looks along z.
Camera fit_camera(const Points3&, const Vector3d& from, const Viewport&);
/// Sees a pattern from above: u to the right, v upwards.
Camera fit_camera(const Points2&, const Viewport&);

/// What is drawn on: every pixel has samples x samples colours, each with the depth of what it
/// shows.
struct Canvas {
  Canvas(int width, int height, Colour background, int samples = 3);

  int width, height, samples;  // [px], [1]
  std::vector<Colour> colour;  // of each sample, row by row
  std::vector<float> depth;    // [m] of each sample; nothing there: -infinity
};

/// Pixels as the mean of their samples.
Image resolve_samples(const Canvas&);

/// What lies nearer hides what lies behind; of two at the same depth the later one is seen. `lift`
/// [m] brings nearer what shall be seen on a surface; on_top: nearer than everything.
constexpr double on_top = 1e9;

/// x        |V|x3 [m]
/// face     |T| colours
void draw_triangles(Canvas&, const Camera&, const Points3& x, const Triangles&,
                    const std::vector<Colour>& face);
/// The same with colours that run from corner to corner.
/// corners  |T| times three colours
void draw_smooth_triangles(Canvas&, const Camera&, const Points3& x, const Triangles&,
                           const std::vector<std::array<Colour, 3>>& corners);
/// Darkens what lies in hollows and behind what is nearer, and lightens ridges a little: by the
/// mean slope of the depths round a pixel, of opposite ones together, so that a plane stays as it
/// is. What is drawn later is not touched. scale [px/m], reach [px] how far it looks
void apply_ambient_occlusion(Canvas&, double scale, double reach);
struct LineStyle {
  double width;  // [px]
  Colour colour;
  double lift = 0;  // [m] see above
};
/// A line with square ends, half a width beyond the points.
void draw_line(Canvas&, const Camera&, const Vector3d& a, const Vector3d& b, const LineStyle&);
/// radius [px]
void draw_disc(Canvas&, const Camera&, const Vector3d& centre, double radius, Colour,
               double lift = 0);
/// Over all edges of a mesh, each once.
void draw_edges(Canvas&, const Camera&, const Points3& x, const Triangles&, const LineStyle&);

/// Printable ASCII in letters of 5 x 8 dots, 6 dots apart, over everything.
/// left, top  [px]
/// dot        [px] size of a dot
void draw_text(Canvas&, double left, double top, double dot, const std::string&, Colour);
/// Width of such a text. [px]
double text_width(const std::string&, double dot);
/// An upright rectangle of the picture, over everything. [px]
void draw_rectangle(Canvas&, const Viewport&, Colour);

/// Each face by how it is turned to the light, on both sides; `front` where its normal points at
/// the viewer, else `back`.
/// to_light  unit
std::vector<Colour> flat_shading(const Points3& x, const Triangles&, const Camera&,
                                 const Vector3d& to_light, Colour front, Colour back);

}  // namespace paperbake
