#include "formats/crease_map.h"

#include "core/curvature.h"
#include "core/error.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfRationalAttribute.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <sys/resource.h>

namespace paperbake {
namespace {

constexpr double fold_width = 0.002;          // [m]
constexpr double angle_step = 1.0 / 16384;    // [rad] of the file

Pattern rectangle(double width, double height) { return {{{0, 0}, {width, 0}, {width, height}, {0, height}}, {}}; }

/// Flat grid over the rectangle, cells nearly square with side `edge`.
Sheet flat_sheet(double width, double height, double edge) {
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
Sheet rolled(Sheet sheet, double k) {
  for (int v = 0; v < sheet.pattern.rows(); ++v) {
    const double s = sheet.pattern(v, 0);
    sheet.x.row(v) << std::sin(k * s) / k, sheet.pattern(v, 1), (std::cos(k * s) - 1) / k;
  }
  return sheet;
}

/// Vertex tensors k(p) across x, as if measured on a sheet.
Points3 tensors(const Sheet& sheet, const std::function<double(Vector2d)>& k) {
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

Image read_image(const std::filesystem::path& path) {
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

Image written(const CreaseMap& map) {
  const Folder folder;
  map.write(folder.path / "map.exr", {});
  return read_image(folder.path / "map.exr");
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(CreaseMap, TheFileHasThreeFloatChannelsAndItsHeaderAndNothingElse) {
  const Folder folder;
  CreaseMap map(rectangle(0.2, 0.1), 64, fold_width);
  const Sheet sheet = flat_sheet(0.2, 0.1, 0.02);
  map.record(sheet, vertex_curvature(sheet));
  map.write(folder.path / "map.exr", {37, 29.97, 4000000000u, "copy90"});

  Imf::InputFile file((folder.path / "map.exr").c_str());
  const Imf::Header& header = file.header();
  std::vector<std::string> channels, attributes;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    channels.push_back(c.name());
    EXPECT_EQ(c.channel().type, Imf::FLOAT);
  }
  for (auto a = header.begin(); a != header.end(); ++a) attributes.push_back(a.name());
  std::sort(attributes.begin(), attributes.end());
  EXPECT_EQ(channels, (std::vector<std::string>{"apex.dist", "fold.angle", "fold.peak"}));
  EXPECT_EQ(attributes, (std::vector<std::string>{
      "channels", "compression", "dataWindow", "displayWindow", "foldWidth", "frame", "framesPerSecond", "lineOrder",
      "pixelAspectRatio", "preset", "screenWindowCenter", "screenWindowWidth", "seed", "texelSize"}));
  EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
  EXPECT_EQ(header.typedAttribute<Imf::IntAttribute>("frame").value(), 37);
  EXPECT_EQ(static_cast<unsigned>(header.typedAttribute<Imf::IntAttribute>("seed").value()), 4000000000u);
  EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("preset").value(), "copy90");
  EXPECT_EQ(header.typedAttribute<Imf::RationalAttribute>("framesPerSecond").value().n, 30000);
  EXPECT_EQ(header.typedAttribute<Imf::RationalAttribute>("framesPerSecond").value().d, 1001u);
  EXPECT_FLOAT_EQ(header.typedAttribute<Imf::FloatAttribute>("texelSize").value(), 0.2f / 64);
  EXPECT_FLOAT_EQ(header.typedAttribute<Imf::FloatAttribute>("foldWidth").value(), 0.002f);
}

TEST(CreaseMap, ACylinderTurnsByTheFoldWidthOverItsRadius) {
  for (const double radius : {0.05, -0.05}) {
    CreaseMap map(rectangle(0.1, 0.1), 128, fold_width);
    const Sheet sheet = rolled(flat_sheet(0.1, 0.1, 0.002), 1 / radius);
    map.record(sheet, vertex_curvature(sheet));
    const Image image = written(map);
    // 8 texels = 3 edges inside the border, where the one-rings are whole; 3 % is what the certificate of the maps promises
    for (int j = 8; j < 120; ++j)
      for (int i = 8; i < 120; ++i) ASSERT_NEAR(image.at(image.angle, i, j), fold_width / radius, 0.03 * fold_width / std::abs(radius));
  }
}

TEST(CreaseMap, AFoldNearTheTopOfThePatternIsNearTheTopRows) {
  CreaseMap map(rectangle(0.1, 0.1), 100, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.005);
  map.record(sheet, tensors(sheet, [](Vector2d p) { return std::abs(p.y() - 0.09) < 1e-6 ? 100.0 : 0.0; }));
  const Image image = written(map);
  // v = 0.9 lies on the line between rows 9 and 10; the fold falls to nothing one edge = 5 rows away
  EXPECT_NEAR(image.at(image.angle, 50, 9), 100 * fold_width * 0.9, 2 * angle_step);
  EXPECT_NEAR(image.at(image.angle, 50, 10), 100 * fold_width * 0.9, 2 * angle_step);
  EXPECT_EQ(image.at(image.angle, 50, 3), 0);
  EXPECT_EQ(image.at(image.angle, 50, 90), 0);
}

TEST(CreaseMap, ATexelIsTheInterpolatedTensorAtItsCentre) {
  CreaseMap map(rectangle(0.1, 0.1), 64, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 20 + 300 * p.x() + 700 * p.y(); }));  // linear: interpolated exactly
  const Image image = written(map);
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      const double x = 0.1 * (i + 0.5) / 64, y = 0.1 * (1 - (j + 0.5) / 64);
      ASSERT_NEAR(image.at(image.angle, i, j), (20 + 300 * x + 700 * y) * fold_width, angle_step) << i << ", " << j;
    }
}

TEST(CreaseMap, TheEigenvalueIsTakenAfterInterpolatingTheTensor) {
  // x-bend at one end, y-bend of the same size at the other: half-way the tensor is k/2 in every direction, not k
  Sheet sheet = flat_sheet(0.1, 0.1, 0.1);
  Points3 S = Points3::Zero(4, 3);
  for (int v = 0; v < 4; ++v) (sheet.pattern(v, 0) > 0.05 ? S(v, 2) : S(v, 0)) = 80;
  CreaseMap map(rectangle(0.1, 0.1), 65, fold_width);  // odd: texel 32 has its centre at u = 1/2
  map.record(sheet, S);
  const Image image = written(map);
  EXPECT_NEAR(image.at(image.angle, 32, 10), 40 * fold_width, angle_step);
  EXPECT_NEAR(image.at(image.angle, 0, 10), 80 * fold_width, 0.01 * 80 * fold_width);
}

TEST(CreaseMap, ThePeakKeepsAnEarlierFoldWithItsSignWhenTheSheetFlattens) {
  CreaseMap map(rectangle(0.1, 0.1), 512, fold_width);  // finer than the memory: interpolated
  const Sheet coarse = flat_sheet(0.1, 0.1, 0.02), fine = flat_sheet(0.1, 0.1, 0.004);  // the sheet is meshed anew
  const auto left_hollow = [](double size) { return [size](Vector2d p) { return p.x() < 0.05 ? -size : size / 2; }; };
  map.record(fine, tensors(fine, left_hollow(150)));
  map.record(coarse, tensors(coarse, left_hollow(-10)));  // now bulges a little on the left
  const Image image = written(map);
  EXPECT_NEAR(image.at(image.angle, 100, 256), 10 * fold_width, angle_step);
  EXPECT_NEAR(image.at(image.peak, 100, 256), -150 * fold_width, 2 * angle_step);
  EXPECT_NEAR(image.at(image.peak, 400, 256), 75 * fold_width, 2 * angle_step);
}

TEST(CreaseMap, ThePeakIsNowhereSmallerThanTheAngle) {
  CreaseMap map(rectangle(0.1, 0.1), 512, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.002);
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 40 * std::sin(900 * p.x()); }));
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 60 * std::sin(1100 * p.x() + 400 * p.y()); }));
  const Image image = written(map);
  int larger = 0;
  for (int t = 0; t < 512 * 512; ++t) {
    ASSERT_GE(std::abs(image.peak[t]), std::abs(image.angle[t])) << t;
    larger += std::abs(image.peak[t]) > std::abs(image.angle[t]) + 0.01;
  }
  EXPECT_GT(larger, 512 * 512 / 10);  // and the first frame is not forgotten
}

TEST(CreaseMap, ThePeakDoesNotVanishWhereItsSignFlips) {
  CreaseMap map(rectangle(0.1, 0.1), 1024, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.05);
  // |peak| = 100 1/m on both sides of u = 1/2, by two frames
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 100 - 1000 * std::max(0.0, p.x() - 0.05); }));
  map.record(sheet, tensors(sheet, [](Vector2d p) { return -(100.1 - 1000 * std::max(0.0, 0.05 - p.x())); }));
  map.record(sheet, tensors(sheet, [](Vector2d) { return 0.0; }));
  const Image image = written(map);
  for (int i = 0; i < 1024; ++i) ASSERT_GT(std::abs(image.at(image.peak, i, 512)), 95 * fold_width) << i;
  EXPECT_GT(image.at(image.peak, 100, 512), 0);
  EXPECT_LT(image.at(image.peak, 900, 512), 0);
}

TEST(CreaseMap, ApexDistanceIsTheDistanceToTheNearestSingularPoint) {
  CreaseMap map(rectangle(0.1, 0.1), 200, fold_width);
  Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  sheet.singular = {{Vector2d(0.02, 0.09), 3, "a"}, {Vector2d(0.075, 0.0312), 5, "b"}, {Vector2d(0.08, 0.04), 5, "c"}};
  map.record(sheet, vertex_curvature(sheet));
  const Image image = written(map);
  for (int j = 0; j < 200; ++j)
    for (int i = 0; i < 200; ++i) {
      const Vector2d p(0.1 * (i + 0.5) / 200, 0.1 * (1 - (j + 0.5) / 200));
      double nearest = 1;
      for (const SingularPoint& s : sheet.singular) nearest = std::min(nearest, (s.pattern - p).norm());
      ASSERT_NEAR(image.at(image.distance, i, j), nearest, 0.1 / 200 / 8);  // rounded to at most an eighth of a texel
    }
}

TEST(CreaseMap, WithoutAnApexTheDistanceIsTheDiagonal) {
  CreaseMap map(rectangle(0.04, 0.03), 32, fold_width);
  const Sheet sheet = flat_sheet(0.04, 0.03, 0.01);
  map.record(sheet, vertex_curvature(sheet));
  for (const float d : written(map).distance) ASSERT_FLOAT_EQ(d, 0.05f);
}

TEST(CreaseMap, NoTexelInsideIsLeftOutOnAMeshOfSlivers) {
  // every triangle has a corner in one point off the centre, so the pattern is covered by 400 slivers
  const int rim = 400;
  const Vector2d centre(0.0312, 0.0577);
  Sheet sheet;
  sheet.pattern.resize(rim + 1, 2);
  sheet.triangles.resize(rim, 3);
  for (int k = 0; k < rim; ++k) {
    const double s = 4.0 * k / rim, f = 0.1 * (s - std::floor(s));
    const Vector2d corners[4] = {{f, 0}, {0.1, f}, {0.1 - f, 0.1}, {0, 0.1 - f}};
    sheet.pattern.row(k) = corners[int(s)];
    sheet.triangles.row(k) << rim, k, (k + 1) % rim;
  }
  sheet.pattern.row(rim) = centre;
  for (const int size : {100, 256, 333}) {
    CreaseMap map(rectangle(0.1, 0.1), size, fold_width);
    map.record(sheet, tensors(sheet, [](Vector2d p) { return 50 + 100 * p.x(); }));
    const Image image = written(map);
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i)
        ASSERT_NEAR(image.at(image.angle, i, j), (50 + 10 * (i + 0.5) / size) * fold_width, angle_step) << size << ": " << i << ", " << j;
  }
}

TEST(CreaseMap, AMeshThatCutsTheCornersOfThePatternLeavesNoHole) {
  Pattern octagon;  // the sheet below is only the square inside it
  for (int k = 0; k < 8; ++k) octagon.outline.push_back(Vector2d(0.05, 0.05) + 0.05 * Vector2d(std::cos(k * M_PI / 4), std::sin(k * M_PI / 4)));
  Sheet sheet;
  sheet.pattern.resize(4, 2);
  for (int k = 0; k < 4; ++k) sheet.pattern.row(k) = octagon.outline[2 * k];
  sheet.triangles.resize(2, 3);
  sheet.triangles << 0, 1, 2, 0, 2, 3;
  CreaseMap map(octagon, 128, fold_width);
  map.record(sheet, tensors(sheet, [](Vector2d) { return 70.0; }));
  const Image image = written(map);
  int covered = 0;
  for (const float a : image.angle) covered += std::abs(a - 70 * fold_width) < angle_step;
  // area of the octagon 2 sqrt(2) r^2 and a rim of 4 texels all around
  EXPECT_GE(covered, 2 * std::sqrt(2.0) * 64 * 64);
  EXPECT_LE(covered, 2 * std::sqrt(2.0) * 69 * 69);
}

TEST(CreaseMap, ANonSquareSheetIsNotStretchedAndPaddedByFourTexels) {
  CreaseMap map(rectangle(0.1, 0.05), 100, fold_width);  // wide: the lower half of the map
  Sheet sheet = flat_sheet(0.1, 0.05, 0.01);
  sheet.singular = {{Vector2d(0.05, 0.025), 1, "a"}};
  map.record(sheet, tensors(sheet, [](Vector2d p) { return 50 + 1000 * p.y(); }));
  const Image image = written(map);
  for (int i = 0; i < 100; ++i) {
    for (int j = 50; j < 100; ++j) ASSERT_NEAR(image.at(image.angle, i, j), (50 + 100 * (1 - (j + 0.5) / 100)) * fold_width, angle_step);
    for (int j = 46; j < 50; ++j) {
      ASSERT_EQ(image.at(image.angle, i, j), image.at(image.angle, i, 50));
      ASSERT_EQ(image.at(image.peak, i, j), image.at(image.peak, i, 50));
      ASSERT_EQ(image.at(image.distance, i, j), image.at(image.distance, i, 50));
    }
    for (int j = 0; j < 46; ++j) {
      ASSERT_EQ(image.at(image.angle, i, j), 0);
      ASSERT_EQ(image.at(image.peak, i, j), 0);
      ASSERT_FLOAT_EQ(image.at(image.distance, i, j), std::hypot(0.1f, 0.05f));
    }
  }
}

TEST(CreaseMap, AHoleOfThePatternIsOutside) {
  Pattern pattern = rectangle(0.1, 0.1);
  pattern.holes = {{{0.03, 0.03}, {0.03, 0.07}, {0.07, 0.07}, {0.07, 0.03}}};
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.01);  // as a mesh with the hole, for the texels outside the hole
  CreaseMap map(pattern, 100, fold_width);
  map.record(sheet, tensors(sheet, [](Vector2d) { return 90.0; }));
  const Image image = written(map);
  EXPECT_EQ(image.at(image.angle, 50, 50), 0);
  EXPECT_EQ(image.at(image.angle, 34, 50), 0);       // 5 texels into the hole
  EXPECT_GT(image.at(image.angle, 33, 50), 0.17f);   // 4 texels: padding
  EXPECT_GT(image.at(image.angle, 29, 50), 0.17f);
}

TEST(CreaseMap, TheSameInputGivesTheSameBytesAtAnyThreadCount) {
  const Folder folder;
  Sheet sheet = rolled(flat_sheet(0.1, 0.1, 0.004), 30);
  sheet.singular = {{Vector2d(0.03, 0.04), 1, "a"}};
  std::string bytes[3];
  for (int run = 0; run < 3; ++run) {
    Imf::setGlobalThreadCount(2 * run);  // 0, 2, 4
    CreaseMap map(rectangle(0.1, 0.1), 300, fold_width);
    map.record(sheet, vertex_curvature(sheet));
    const std::filesystem::path path = folder.path / (std::to_string(run) + ".exr");
    map.write(path, {});
    bytes[run] = bytes_of(path);
  }
  Imf::setGlobalThreadCount(0);
  ASSERT_GT(bytes[0].size(), 1000u);
  EXPECT_EQ(bytes[0], bytes[1]);
  EXPECT_EQ(bytes[0], bytes[2]);
}

TEST(CreaseMap, AFolderThatIsNotThereIsAFolderError) {
  const Folder folder;
  CreaseMap map(rectangle(0.1, 0.1), 16, fold_width);
  try {
    map.write(folder.path / "missing" / "map.exr", {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.fault, Fault::folder);
    EXPECT_NE(error.place.find("map.exr"), std::string::npos);
  }
}

TEST(CreaseMap, AFullDiskIsAFolderErrorAndLeavesNoFile) {
  const Folder folder;
  // a flat sheet: the file is so small that all of it waits in a buffer until the end, where errors are easily lost
  CreaseMap map(rectangle(0.1, 0.1), 64, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  map.record(sheet, vertex_curvature(sheet));
  map.write(folder.path / "map.exr", {});
  ASSERT_GT(std::filesystem::remove_all(folder.path / "map.exr"), 0u);

  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{512, before.rlim_max};  // stands for a disk with 512 bytes left
  const auto old = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  bool folder_error = false;
  try {
    map.write(folder.path / "map.exr", {});
  } catch (const Error& error) {
    folder_error = error.fault == Fault::folder;
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old);
  EXPECT_TRUE(folder_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

TEST(CreaseMap, ACurvatureThatIsNotANumberIsRefused) {
  CreaseMap map(rectangle(0.1, 0.1), 16, fold_width);
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.05);
  Points3 S = tensors(sheet, [](Vector2d) { return 1.0; });
  S(4, 1) = std::nan("");
  EXPECT_THROW(map.record(sheet, S), Error);
}

}  // namespace
}  // namespace paperbake
