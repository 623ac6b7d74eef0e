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
/// Linear interpolation a (1-t) + b t; t is clamped to [0, 1].
Colour mix(Colour a, Colour b, double t);

struct Image {
  int width = 0, height = 0;   // [px]
  std::vector<Colour> pixels;  // row by row from the top left
  const Colour& at(int column, int row) const { return pixels[std::size_t(row) * width + column]; }
};

/// The bytes of a PNG file with 8 bits per channel; equal images give equal bytes.
std::string png_bytes(const Image&);

/// Writes png_bytes as an AtomicFile. throws Error(ErrorCode::folder)
void write_png(const std::filesystem::path&, const Image&);

/// An orthographic projection into an image, whose columns run to the right and rows downwards.
struct Camera {
  // [m] the point of the world that is projected to ...
  Vector3d centre{0, 0, 0};
  Vector2d at{0, 0};                                       // [px] ... this point of the image
  Vector3d right{1, 0, 0}, up{0, 1, 0}, towards{0, 0, 1};  // unit; towards: to the viewer
  double scale = 1;                                        // [px/m]

  /// Column and row [px], and depth [m]: larger is nearer to the viewer.
  Vector3d project(const Vector3d& p) const;
};

/// An upright rectangle of an image.
struct Viewport {
  double left, top, width, height;  // [px]
};
/// A camera that looks from direction `from` and sees all points as large as the viewport allows.
/// z points up in the image, or y when the camera looks along z.
Camera fit_camera(const Points3&, const Vector3d& from, const Viewport&);
/// A camera that sees a pattern from above: u to the right, v upwards.
Camera fit_camera(const Points2&, const Viewport&);

/// A supersampled image with a depth buffer: each pixel has samples x samples colours and depths.
struct Canvas {
  Canvas(int width, int height, Colour background, int samples = 3);

  int width, height, samples;  // [px], [px], [1]
  std::vector<Colour> colour;  // of each sample, row by row
  std::vector<float> depth;    // [m] of each sample; -infinity where nothing is drawn
};

/// The image whose pixels are the means of their samples.
Image resolve_samples(const Canvas&);

// What is drawn hides everything of smaller or equal depth. `lift` [m] is added to the depth of
// what shall be seen on a surface; on_top is in front of everything.
constexpr double on_top = 1e9;

/// Draws triangles, each of one colour.
/// x     |V|x3 [m]
/// face  |T| colours
void draw_triangles(Canvas&, const Camera&, const Points3& x, const Triangles&,
                    const std::vector<Colour>& face);
/// Draws triangles whose colours are interpolated linearly between their corners.
/// x        |V|x3 [m]
/// corners  |T| times three colours
void draw_smooth_triangles(Canvas&, const Camera&, const Points3& x, const Triangles&,
                           const std::vector<std::array<Colour, 3>>& corners);
/// Screen-space ambient occlusion: darkens hollows and what lies behind nearer parts, and lightens
/// ridges a little. Measured by the mean slope of the depth around a pixel, opposite directions
/// taken together, so that a plane at any angle keeps its colour. Only affects what is already
/// drawn.
/// scale  [px/m] of the camera
/// reach  [px]   radius of the neighbourhood
void apply_ambient_occlusion(Canvas&, double scale, double reach);

struct LineStyle {
  double width;  // [px]
  Colour colour;
  double lift = 0;  // [m] see on_top
};
/// Draws a line with square ends, which extend it by half its width.
void draw_line(Canvas&, const Camera&, const Vector3d& a, const Vector3d& b, const LineStyle&);
/// Draws a disc that faces the viewer.
/// radius  [px]
void draw_disc(Canvas&, const Camera&, const Vector3d& centre, double radius, Colour,
               double lift = 0);
/// Draws a line along each edge of a mesh.
void draw_edges(Canvas&, const Camera&, const Points3& x, const Triangles&, const LineStyle&);

/// Writes printable ASCII on top of everything, in letters of 5 x 8 dots, 6 dots from one letter
/// to the next.
/// left, top  [px]
/// dot        [px] size of a dot
void draw_text(Canvas&, double left, double top, double dot, const std::string&, Colour);
/// Width of such a text. [px]
double text_width(const std::string&, double dot);
/// Fills a rectangle, on top of everything.
void draw_rectangle(Canvas&, const Viewport&, Colour);

/// A colour for each face by its angle to the light, lit from both sides: `front` where the normal
/// points towards the viewer, else `back`.
/// to_light  unit
std::vector<Colour> flat_shading(const Points3& x, const Triangles&, const Camera&,
                                 const Vector3d& to_light, Colour front, Colour back);

}  // namespace paperbake
