#pragma once

#include "formats/crease_map.h"
#include "tests/test_shots.h"

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

/// Sheets whose creases are known, and the images that maps of them are in the file.
namespace paperbake::test {

inline constexpr double fold_width = 0.002;        // [m]
inline constexpr double angle_step = 1.0 / 16384;  // [rad] of the file

/// Flat grid over the rectangle, cells nearly square with side `edge`.
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

/// Rolled about the y axis to curvature k [1/m], bulging to its normal when k > 0.
inline Sheet rolled(Sheet sheet, double k) {
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const double s = sheet.pattern(v, 0);
    sheet.x.row(v) << std::sin(k * s) / k, sheet.pattern(v, 1), (std::cos(k * s) - 1) / k;
  }
  return sheet;
}

/// Vertex tensors k(p) across x, as if measured on a sheet.
inline Points3 tensors(const Sheet& sheet, const std::function<double(Vector2d)>& k) {
  Points3 S = Points3::Zero(sheet.pattern.rows(), 3);
  for (int v = 0; v < S.rows(); ++v) S(v, 0) = k(sheet.pattern.row(v).transpose());
  return S;
}

/// A folder that goes when the test ends.
struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               (std::string("paperbake_maps_") + testing::UnitTest::GetInstance()->current_test_info()->name());
  Folder() { std::filesystem::remove_all(path), std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

struct Image {
  int size;
  std::vector<float> angle, peak, distance;
  float at(const std::vector<float>& channel, int i, int j) const { return channel[j * size + i]; }
};

inline Image read_image(const std::filesystem::path& path) {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  Image image{window.max.x + 1, {}, {}, {}};
  EXPECT_EQ(window, Imath::Box2i({0, 0}, {image.size - 1, image.size - 1}));
  Imf::FrameBuffer frame_buffer;
  for (auto [name, channel] : {std::pair("fold.angle", &image.angle), {"fold.peak", &image.peak}, {"apex.dist", &image.distance}}) {
    channel->assign(image.size * image.size, -99);
    frame_buffer.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(channel->data()), 4, 4 * image.size));
  }
  file.setFrameBuffer(frame_buffer);
  file.readPixels(0, image.size - 1);
  return image;
}

inline Image written(const CreaseMap& map) {
  const Folder folder;
  map.write(folder.path / "map.exr", {});
  return read_image(folder.path / "map.exr");
}

}  // namespace paperbake::test
