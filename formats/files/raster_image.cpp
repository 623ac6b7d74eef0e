#include "formats/files/raster_image.h"

#include "core/geometry/measure.h"
#include "core/model/error.h"
#include "formats/files/atomic_file.h"
#include "formats/files/bitmap_font.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <png.h>
#include <set>

namespace paperbake {
namespace {

static_assert(sizeof(Colour) == 3, "libpng reads the pixels in place");

/// Fills a triangle whose corners are given in samples: x column, y row, z depth [m]. paint(x, y)
/// is its colour at a sample.
template <class Paint>
void fill_triangle(Canvas& canvas, const Vector3d& a, const Vector3d& b, const Vector3d& c,
                   const Paint& paint) {
  const Vector3d ab = b - a, ac = c - a;
  const double twice_area = ab.x() * ac.y() - ac.x() * ab.y();
  const double zx = twice_area == 0 ? 0 : (ab.z() * ac.y() - ac.z() * ab.y()) / twice_area;
  const double zy = twice_area == 0 ? 0 : (ac.z() * ab.x() - ab.z() * ac.x()) / twice_area;
  const int columns = canvas.width * canvas.samples, rows = canvas.height * canvas.samples;
  const Vector3d* corners[] = {&a, &b, &c, &a};
  const double top = std::min({a.y(), b.y(), c.y()}), bottom = std::max({a.y(), b.y(), c.y()});
  if (!(bottom >= 0 && top <= rows)) return;
  for (int row = static_cast<int>(std::max(0.0, std::floor(top)));
       row < rows && row + 0.5 <= bottom; ++row) {
    const double y = row + 0.5;
    double from = std::numeric_limits<double>::infinity(), to = -from;  // span of the row inside
    for (int i = 0; i < 3; ++i) {
      // computed from the upper end for both triangles of an edge, so that no gap opens between
      // them
      const bool upwards = corners[i]->y() < corners[i + 1]->y();
      const Vector3d &p = *corners[i + !upwards], &q = *corners[i + upwards];
      if (p.y() == q.y() || y < std::min(p.y(), q.y()) || y > std::max(p.y(), q.y())) continue;
      const double x = p.x() + (y - p.y()) / (q.y() - p.y()) * (q.x() - p.x());
      from = std::min(from, x);
      to = std::max(to, x);
    }
    if (!(to >= 0 && from <= columns)) continue;
    for (int column = static_cast<int>(std::max(0.0, std::ceil(from - 0.5)));
         column < columns && column + 0.5 <= to; ++column) {
      const auto z = static_cast<float>(a.z() + zx * (column + 0.5 - a.x()) + zy * (y - a.y()));
      const std::size_t k = std::size_t(row) * columns + column;
      if (z < canvas.depth[k]) continue;
      canvas.depth[k] = z;
      canvas.colour[k] = paint(column + 0.5, y);
    }
  }
}

void fill_triangle(Canvas& canvas, const Vector3d& a, const Vector3d& b, const Vector3d& c,
                   Colour colour) {
  fill_triangle(canvas, a, b, c, [&](double, double) { return colour; });
}

/// Linear interpolation of colours given at the three corners of a triangle, in samples.
struct ColourGradient {
  // red, green, blue at the first corner; their change per column and per row
  Vector3d corner, across, down;

  ColourGradient(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                 const std::array<Colour, 3>& colours) {
    const auto rgb = [](Colour k) { return Vector3d(k.red, k.green, k.blue); };
    const Vector3d ab = b - a, ac = c - a, to_b = rgb(colours[1]) - rgb(colours[0]),
                   to_c = rgb(colours[2]) - rgb(colours[0]);
    const double twice_area = ab.x() * ac.y() - ac.x() * ab.y();
    corner = rgb(colours[0]);
    across = down = Vector3d::Zero();
    if (twice_area == 0) return;
    across = (to_b * ac.y() - to_c * ab.y()) / twice_area;
    down = (to_c * ab.x() - to_b * ac.x()) / twice_area;
  }
  Colour at(double columns, double rows) const {
    const Vector3d c = (corner + columns * across + rows * down).cwiseMax(0).cwiseMin(255);
    return {static_cast<std::uint8_t>(c.x() + 0.5), static_cast<std::uint8_t>(c.y() + 0.5),
            static_cast<std::uint8_t>(c.z() + 0.5)};
  }
};

/// Column and row in samples, and depth [m].
Vector3d project_to_samples(const Canvas& canvas, const Camera& camera, const Vector3d& p,
                            double lift) {
  const Vector3d q = camera.project(p);
  return {q.x() * canvas.samples, q.y() * canvas.samples, q.z() + lift};
}

Camera fit(Camera camera, const Points3& points, const Viewport& frame) {
  camera.at = {frame.left + 0.5 * frame.width, frame.top + 0.5 * frame.height};
  if (points.rows() == 0) return camera;
  Eigen::AlignedBox3d seen;
  for (int i = 0; i < points.rows(); ++i) {
    const Vector3d p = points.row(i);
    seen.extend(Vector3d(camera.right.dot(p), camera.up.dot(p), camera.towards.dot(p)));
  }
  const Vector3d middle = seen.center(), size = seen.sizes();
  camera.centre = middle.x() * camera.right + middle.y() * camera.up + middle.z() * camera.towards;
  const double scale = std::min(frame.width / size.x(), frame.height / size.y());
  camera.scale = std::isfinite(scale) ? scale : 1;
  return camera;
}

/// Two opposite neighbours of a pixel, at (column, row) and (-column, -row) from it.
struct SamplePair {
  int column, row;  // [px]
  double distance;  // [px]
};

/// Pairs of neighbours on rings around a pixel, at most `reach` [px] away.
std::vector<SamplePair> sample_pairs(double reach) {
  constexpr int spokes = 8, rings = 4;
  std::vector<SamplePair> pairs;
  for (int ring = 1; ring <= rings; ++ring)
    for (int k = 0; k < spokes; ++k) {
      const double turn = M_PI * (k + 0.5 * (ring % 2)) / spokes, r = reach * ring / rings;
      const int column = static_cast<int>(std::lround(r * std::cos(turn))),
                row = static_cast<int>(std::lround(r * std::sin(turn)));
      if (column || row) pairs.push_back({column, row, std::hypot(column, row)});
    }
  return pairs;
}

}  // namespace

Colour mix(Colour a, Colour b, double t) {
  if (t <= 0) return a;
  if (t >= 1) return b;
  const auto one = [&](int from, int to) {
    return static_cast<std::uint8_t>(from + t * (to - from) + 0.5);
  };
  return {one(a.red, b.red), one(a.green, b.green), one(a.blue, b.blue)};
}

std::string png_bytes(const Image& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.format = PNG_FORMAT_RGB;
  png.width = image.width;
  png.height = image.height;
  png.flags = PNG_IMAGE_FLAG_FAST;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(png), '\0');
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&png, bytes.data(), &size, /*convert_to_8_bit=*/0,
                                 image.pixels.data(), /*row_stride=*/0, /*colormap=*/nullptr))
    throw Error(ErrorCode::folder, "picture",
                std::string("It cannot be encoded: ") + png.message + ".");
  bytes.resize(size);
  return bytes;
}

void write_png(const std::filesystem::path& path, const Image& image) {
  write_atomically(path, png_bytes(image));
}

Vector3d Camera::project(const Vector3d& p) const {
  const Vector3d d = p - centre;
  return {at.x() + scale * right.dot(d), at.y() - scale * up.dot(d), towards.dot(d)};
}

Camera fit_camera(const Points3& points, const Vector3d& from, const Viewport& frame) {
  Camera camera;
  camera.towards = from.normalized();
  const Vector3d upwards =
      std::abs(camera.towards.z()) < 0.999 ? Vector3d::UnitZ() : Vector3d::UnitY();
  camera.right = upwards.cross(camera.towards).normalized();
  camera.up = camera.towards.cross(camera.right);
  return fit(camera, points, frame);
}

Camera fit_camera(const Points2& points, const Viewport& frame) {
  Points3 flat = Points3::Zero(points.rows(), 3);
  flat.leftCols<2>() = points;
  return fit(Camera{}, flat, frame);
}

Canvas::Canvas(int width, int height, Colour background, int samples)
    : width(width),
      height(height),
      samples(samples),
      colour(std::size_t(width) * height * samples * samples, background),
      depth(colour.size(), -std::numeric_limits<float>::infinity()) {}

Image resolve_samples(const Canvas& canvas) {
  Image image{canvas.width, canvas.height, {}};
  image.pixels.reserve(std::size_t(canvas.width) * canvas.height);
  const int n = canvas.samples, columns = canvas.width * n;
  for (int row = 0; row < canvas.height; ++row)
    for (int column = 0; column < canvas.width; ++column) {
      int red = 0, green = 0, blue = 0;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const Colour& c = canvas.colour[std::size_t(row * n + j) * columns + column * n + i];
          red += c.red;
          green += c.green;
          blue += c.blue;
        }
      const auto mean = [&](int sum) {
        return static_cast<std::uint8_t>((sum + n * n / 2) / (n * n));
      };
      image.pixels.push_back({mean(red), mean(green), mean(blue)});
    }
  return image;
}

void draw_triangles(Canvas& canvas, const Camera& camera, const Points3& x,
                    const Triangles& triangles, const std::vector<Colour>& face) {
  for (int t = 0; t < triangles.rows(); ++t) {
    Vector3d corner[3];
    for (int i = 0; i < 3; ++i)
      corner[i] = project_to_samples(canvas, camera, x.row(triangles(t, i)), 0);
    fill_triangle(canvas, corner[0], corner[1], corner[2], face[t]);
  }
}

void draw_smooth_triangles(Canvas& canvas, const Camera& camera, const Points3& x,
                           const Triangles& triangles,
                           const std::vector<std::array<Colour, 3>>& corners) {
  for (int t = 0; t < triangles.rows(); ++t) {
    Vector3d p[3];
    for (int i = 0; i < 3; ++i)
      p[i] = project_to_samples(canvas, camera, x.row(triangles(t, i)), 0);
    const ColourGradient gradient(p[0], p[1], p[2], corners[t]);
    fill_triangle(canvas, p[0], p[1], p[2], [&](double column, double row) {
      return gradient.at(column - p[0].x(), row - p[0].y());
    });
  }
}

void apply_ambient_occlusion(Canvas& canvas, double scale, double reach) {
  constexpr double strength = 0.9, max_darkening = 0.55, max_brightening = 0.12;
  const std::vector<SamplePair> pairs = sample_pairs(reach);
  const int n = canvas.samples, columns = canvas.width * n;
  const auto paper = [](float depth) {
    return depth > -std::numeric_limits<float>::infinity() && depth < 0.5 * on_top;
  };
  const auto depth = [&](int column, int row) {
    return canvas.depth[std::size_t(row * n + n / 2) * columns + column * n + n / 2];
  };
  for (int row = 0; row < canvas.height; ++row)
    for (int column = 0; column < canvas.width; ++column) {
      const float here = depth(column, row);
      if (!paper(here)) continue;
      double rise = 0;  // mean slope of the depth up to its neighbours
      for (const SamplePair& pair : pairs) {
        const int left = column - pair.column, right = column + pair.column, above = row - pair.row,
                  below = row + pair.row;
        if (std::min(left, right) < 0 || std::max(left, right) >= canvas.width || above < 0 ||
            below >= canvas.height)
          continue;
        const float a = depth(left, above), b = depth(right, below);
        if (paper(a) && paper(b))
          rise += std::clamp(0.5 * scale * (double(a) - here + double(b) - here) / pair.distance,
                             -1.0, 1.0);
      }
      rise /= pairs.size();
      const double darker = std::clamp(strength * rise, -max_brightening, max_darkening);
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const std::size_t k = std::size_t(row * n + j) * columns + column * n + i;
          // samples of another layer, or of none, keep their colour
          if (!(std::abs(canvas.depth[k] - here) * scale < 0.5 * reach)) continue;
          Colour& c = canvas.colour[k];
          c = darker > 0 ? mix(c, {}, darker) : mix(c, {255, 255, 255}, -darker);
        }
    }
}

void draw_line(Canvas& canvas, const Camera& camera, const Vector3d& a, const Vector3d& b,
               const LineStyle& style) {
  const Vector3d p = project_to_samples(canvas, camera, a, style.lift),
                 q = project_to_samples(canvas, camera, b, style.lift);
  const double half = 0.5 * style.width * canvas.samples,
               length = std::hypot(q.x() - p.x(), q.y() - p.y());
  const Vector3d along =
      length > 0 ? Vector3d(half / length * (q.x() - p.x()), half / length * (q.y() - p.y()), 0)
                 : Vector3d(half, 0, 0);
  const Vector3d aside(-along.y(), along.x(), 0);
  const Vector3d corners[] = {p - along - aside, q + along - aside, q + along + aside,
                              p - along + aside};
  fill_triangle(canvas, corners[0], corners[1], corners[2], style.colour);
  fill_triangle(canvas, corners[0], corners[2], corners[3], style.colour);
}

void draw_disc(Canvas& canvas, const Camera& camera, const Vector3d& centre, double radius,
               Colour colour, double lift) {
  constexpr int sides = 32;
  const Vector3d p = project_to_samples(canvas, camera, centre, lift);
  const double r = radius * canvas.samples;
  const auto rim = [&](int k) {
    return Vector3d(p.x() + r * std::cos(2 * M_PI * k / sides),
                    p.y() + r * std::sin(2 * M_PI * k / sides), p.z());
  };
  for (int k = 0; k < sides; ++k) fill_triangle(canvas, p, rim(k), rim(k + 1), colour);
}

void draw_edges(Canvas& canvas, const Camera& camera, const Points3& x, const Triangles& triangles,
                const LineStyle& style) {
  std::set<std::pair<int, int>> drawn;
  for (int t = 0; t < triangles.rows(); ++t)
    for (int i = 0; i < 3; ++i) {
      const int a = triangles(t, i), b = triangles(t, (i + 1) % 3);
      if (drawn.emplace(std::minmax(a, b)).second)
        draw_line(canvas, camera, x.row(a), x.row(b), style);
    }
}

void draw_text(Canvas& canvas, double left, double top, double dot, const std::string& text,
               Colour colour) {
  for (std::size_t k = 0; k < text.size(); ++k) {
    if (text[k] <= ' ' || text[k] > '~') continue;
    for (int column = 0; column < 5; ++column)
      for (int row = 0; row < 8; ++row)
        if (bitmap_font[text[k] - ' '][column] >> row & 1)
          draw_rectangle(canvas, {left + dot * (6.0 * k + column), top + dot * row, dot, dot},
                         colour);
  }
}

double text_width(const std::string& text, double dot) {
  return text.empty() ? 0 : dot * (6.0 * text.size() - 1);
}

void draw_rectangle(Canvas& canvas, const Viewport& frame, Colour colour) {
  const int n = canvas.samples, columns = canvas.width * n, rows = canvas.height * n;
  const auto sample = [&](double px, int most) {
    return std::clamp(static_cast<int>(std::lround(px * n)), 0, most);
  };
  for (int row = sample(frame.top, rows); row < sample(frame.top + frame.height, rows); ++row)
    for (int column = sample(frame.left, columns);
         column < sample(frame.left + frame.width, columns); ++column) {
      canvas.colour[std::size_t(row) * columns + column] = colour;
      canvas.depth[std::size_t(row) * columns + column] = static_cast<float>(on_top);
    }
}

std::vector<Colour> flat_shading(const Points3& x, const Triangles& triangles, const Camera& camera,
                                 const Vector3d& to_light, Colour front, Colour back) {
  constexpr double ambient = 0.25;
  std::vector<Colour> face(triangles.rows());
  for (int t = 0; t < triangles.rows(); ++t) {
    const Vector3d a = x.row(triangles(t, 0)), b = x.row(triangles(t, 1)),
                   c = x.row(triangles(t, 2));
    Vector3d normal = triangle_normal(a, b, c);
    const bool seen_from_front = normal.dot(camera.towards) >= 0;
    if (!seen_from_front) normal = -normal;
    // half Lambert: faces turned away from the light are not black
    const double light = ambient + (1 - ambient) * 0.5 * (1 + normal.dot(to_light));
    face[t] = mix({}, seen_from_front ? front : back, light);
  }
  return face;
}

}  // namespace paperbake
