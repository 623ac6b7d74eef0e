#pragma once

#include "formats/maps/crease_map.h"
#include "formats/maps/map_file.h"
#include "tests/core/test_shots.h"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

/// Sheets with known creases, and the texels of the files of their maps.
namespace paperbake::test {

inline constexpr double fold_width = 0.002;      // [m]
inline constexpr double angle_step = 1.0 / 512;  // [rad] resolution of angles in the file

/// A flat rectangle with a grid of nearly square cells of side `edge`.
inline Sheet flat_sheet(double width, double height, double edge) {
  const int nx = std::lround(width / edge), ny = std::lround(height / edge), row = nx + 1;
  Sheet sheet;
  sheet.pattern.resize((nx + 1) * (ny + 1), 2);
  sheet.triangles.resize(2 * nx * ny, 3);
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) sheet.pattern.row(j * row + i) << width * i / nx, height * j / ny;
  for (int j = 0, t = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i, t += 2) {
      const int a = j * row + i, b = a + 1, c = b + row, d = a + row;
      sheet.triangles.row(t) << a, b, c;
      sheet.triangles.row(t + 1) << a, c, d;
    }
  sheet.x = Points3::Zero(sheet.pattern.rows(), 3);
  sheet.x.leftCols<2>() = sheet.pattern;
  return sheet;
}

/// A flat sheet rolled about the y axis to curvature k [1/m], bulging towards its normal when k >
/// 0.
inline Sheet rolled(Sheet sheet, double k) {
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const double s = sheet.pattern(v, 0);
    sheet.x.row(v) << std::sin(k * s) / k, sheet.pattern(v, 1), (std::cos(k * s) - 1) / k;
  }
  return sheet;
}

/// Curvature tensors at the vertices with curvature k(p) in direction x, as if measured on a sheet.
inline Points3 tensors(const Sheet& sheet, const std::function<double(Vector2d)>& k) {
  Points3 S = Points3::Zero(sheet.pattern.rows(), 3);
  for (int v = 0; v < S.rows(); ++v) S(v, 0) = k(sheet.pattern.row(v).transpose());
  return S;
}

/// A folder that is deleted at the end of the test.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               (std::string("paperbake_maps_") +
                                testing::UnitTest::GetInstance()->current_test_info()->name());
  Folder() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

/// The texels of a file or of one of its levels, row by row from the top.
struct Image {
  int size = 0;
  std::vector<MapTexel> texels;
  const MapTexel& at(int i, int j) const { return texels[std::size_t(j) * size + i]; }
};

inline Imf::FrameBuffer frame_buffer(Image& image) {
  image.texels.assign(std::size_t(image.size) * image.size, MapTexel());
  Imf::FrameBuffer buffer;
  const auto add = [&](const char* name, auto& member) {
    const auto type = sizeof member == 2               ? Imf::HALF
                      : std::string(name) == "apex.id" ? Imf::UINT
                                                       : Imf::FLOAT;
    buffer.insert(name, Imf::Slice(type, reinterpret_cast<char*>(&member), sizeof(MapTexel),
                                   sizeof(MapTexel) * image.size));
  };
  MapTexel& t = image.texels[0];
  add("R", t.r);
  add("G", t.g);
  add("B", t.b);
  add("A", t.a);
  add("fold.angle", t.fold_angle);
  add("fold.plastic", t.fold_plastic);
  add("fold.peak", t.fold_peak);
  add("age.crease", t.age_crease);
  add("age.apex", t.age_apex);
  add("apex.dist", t.apex_dist);
  add("apex.cone", t.apex_cone);
  add("apex.id", t.apex_id);
  add("dir.x", t.dir_x);
  add("dir.y", t.dir_y);
  add("strain.min", t.strain_min);
  add("strain.max", t.strain_max);
  return buffer;
}

inline Image read_image(const std::filesystem::path& path) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  Image image{window.max.x + 1, {}};
  EXPECT_EQ(window, Imath::Box2i({0, 0}, {image.size - 1, image.size - 1}));
  file.setFrameBuffer(frame_buffer(image));
  file.readPixels(0, image.size - 1);
  return image;
}

inline Image written(const CreaseMap& map, const MapInfo& info = {}) {
  const Folder folder;
  map.write(folder.path / "map.exr", info);
  return read_image(folder.path / "map.exr");
}

inline CreaseMapOptions of_size(int size) {
  CreaseMapOptions options;
  options.size = size;
  options.fold_width = fold_width;
  return options;
}

/// A rectangle folded by `angle` [rad] along the line from (bottom, 0) to (top, height), which runs
/// along edges of the mesh; it bulges towards the normal when angle > 0.
inline Sheet folded_sheet(double width, double height, double bottom, double top, double angle) {
  constexpr int rows = 12;  // of vertices along the fold
  const int row = 5;        // left border, beside the fold, fold, beside the fold, right border
  Sheet sheet;
  sheet.pattern.resize(rows * row, 2);
  sheet.triangles.resize(2 * (rows - 1) * (row - 1), 3);
  const Vector2d on(bottom, 0), along = Vector2d(top - bottom, height).normalized();
  sheet.x.resize(rows * row, 3);
  for (int j = 0, t = 0; j < rows; ++j) {
    const double v = height * j / (rows - 1), fold = bottom + (top - bottom) * v / height;
    const double u[row] = {0, fold - 0.1 * width, fold, fold + 0.1 * width, width};
    for (int i = 0; i < row; ++i) {
      const Vector2d p(u[i], v);
      sheet.pattern.row(row * j + i) = p;
      // distances along the fold, and to its right
      const double s = along.dot(p - on), d = along.y() * (p - on).x() - along.x() * (p - on).y();
      sheet.x.row(row * j + i) << (d > 0 ? d * std::cos(angle) : d), s,
          (d > 0 ? -d * std::sin(angle) : 0);
      if (j + 1 == rows || i + 1 == row) continue;
      const int a = row * j + i, b = a + 1, c = b + row, e = a + row;
      sheet.triangles.row(t++) << a, b, c;
      sheet.triangles.row(t++) << a, c, e;
    }
  }
  return sheet;
}

}  // namespace paperbake::test
