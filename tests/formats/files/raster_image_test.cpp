#include "formats/files/raster_image.h"

#include "core/model/error.h"
#include "tests/core/test_meshes.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <png.h>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

constexpr Colour white{255, 255, 255}, red{255, 0, 0}, blue{0, 0, 255}, black{0, 0, 0};

/// A camera with one pixel per metre that looks along z and has (0, 0) at the lower left.
Camera plain_camera(int height) {
  Camera camera;
  camera.at = {0, static_cast<double>(height)};
  return camera;
}

/// Draws an upright square of two triangles, with its lower left corner at (left, bottom) and depth
/// z.
void draw_square(Canvas& canvas, double left, double bottom, double side, double z, Colour colour) {
  Points3 x(4, 3);
  x << left, bottom, z, left + side, bottom, z, left + side, bottom + side, z, left, bottom + side,
      z;
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 0, 2, 3;
  draw_triangles(canvas, plain_camera(canvas.height), x, triangles, {colour, colour});
}

int count(const Image& image, Colour colour) {
  return static_cast<int>(std::count(image.pixels.begin(), image.pixels.end(), colour));
}

/// Area of a white image that was painted black. [px]
double blackened(const Image& image) {
  double sum = 0;
  for (const Colour& c : image.pixels) sum += (255 - c.red) / 255.0;
  return sum;
}

/// Two squares side by side, 100 px each, that rise towards the viewer from their common edge with
/// these slopes.
Canvas valley(double left_slope, double right_slope) {
  Canvas canvas(200, 100, white);
  Points3 x(6, 3);
  x << 0, 0, 100 * left_slope, 100, 0, 0, 200, 0, 100 * right_slope, 0, 100, 100 * left_slope, 100,
      100, 0, 200, 100, 100 * right_slope;
  Triangles triangles(4, 3);
  triangles << 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4;
  draw_triangles(canvas, plain_camera(100), x, triangles, std::vector<Colour>(4, {128, 128, 128}));
  return canvas;
}

TEST(RasterImage, ColoursAreInterpolatedLinearlyBetweenCorners) {
  Canvas canvas(100, 100, white);
  Points3 x(3, 3);
  x << 0, 0, 0, 100, 0, 0, 0, 100, 0;
  Triangles triangle(1, 3);
  triangle << 0, 1, 2;
  draw_smooth_triangles(canvas, plain_camera(100), x, triangle,
                        {{Colour{0, 0, 0}, Colour{200, 0, 0}, Colour{0, 100, 0}}});
  const Image image = resolve_samples(canvas);
  for (const auto& [column, row] : {std::pair(10, 90), std::pair(40, 70), std::pair(20, 30)}) {
    // each sample is rounded by up to 1
    EXPECT_NEAR(image.at(column, row).red, 2.0 * (column + 0.5), 1.01);
    EXPECT_NEAR(image.at(column, row).green, 100 - (row + 0.5), 1.01);
    EXPECT_EQ(image.at(column, row).blue, 0);
  }
  EXPECT_EQ(image.at(90, 10), white);
}

TEST(RasterImage, AmbientOcclusionDarkensValleysAndLeavesPlanesUnchanged) {
  const auto middle_and_side = [](Canvas canvas) {
    apply_ambient_occlusion(canvas, 1, 10);
    const Image image = resolve_samples(canvas);
    return std::pair(int(image.at(100, 50).red), int(image.at(40, 50).red));
  };
  EXPECT_EQ(middle_and_side(valley(0.7, -0.7)), std::pair(128, 128)) << "a plane that leans";
  const auto [hollow, beside] = middle_and_side(valley(0.7, 0.7));
  EXPECT_LT(hollow, 90);
  EXPECT_EQ(beside, 128);
  const auto [ridge, flank] = middle_and_side(valley(-0.7, -0.7));
  EXPECT_GT(ridge, 134);
  EXPECT_EQ(flank, 128);
}

TEST(RasterImage, ATriangleCoversThePixelsInsideItAndNoOthers) {
  Canvas canvas(20, 10, white);
  Points3 x(3, 3);
  x << 2, 1, 0, 18, 1, 0, 2, 9, 0;  // right-angled: inside below x/16 + y/8 = 1.25
  Triangles triangle(1, 3);
  triangle << 0, 1, 2;
  draw_triangles(canvas, plain_camera(10), x, triangle, {red});
  const Image image = resolve_samples(canvas);
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 20; ++column) {
      const auto inside = [&](double u, double v) {
        return u >= 2 && v >= 1 && u / 16 + v / 8 <= 1.25;
      };
      const double u = column, v = 9 - row;  // lower left corner of the pixel
      const int corners = inside(u, v) + inside(u + 1, v) + inside(u, v + 1) + inside(u + 1, v + 1);
      if (corners == 4 || corners == 0) {
        EXPECT_EQ(image.at(column, row), corners == 4 ? red : white) << column << " " << row;
      }
    }
  EXPECT_GT(count(image, red), 40);
}

TEST(RasterImage, ThePaintedAreaIsThatOfTheTriangle) {
  Canvas canvas(100, 100, white);
  Points3 x(3, 3);
  x << 7.3, 11.1, 0, 91.7, 24.9, 0, 33.3, 88.2, 0;
  Triangles triangle(1, 3);
  triangle << 0, 1, 2;
  draw_triangles(canvas, plain_camera(100), x, triangle, {black});
  const double area = 0.5 * std::abs((91.7 - 7.3) * (88.2 - 11.1) - (33.3 - 7.3) * (24.9 - 11.1));
  EXPECT_NEAR(blackened(resolve_samples(canvas)) / area, 1, 2e-3);  // 9 samples per pixel
}

TEST(RasterImage, NearerTrianglesHideFartherOnesInEitherOrder) {
  for (const bool near_first : {true, false}) {
    Canvas canvas(10, 10, white);
    if (near_first) draw_square(canvas, 2, 2, 4, 1, red);
    draw_square(canvas, 4, 4, 4, 0, blue);
    if (!near_first) draw_square(canvas, 2, 2, 4, 1, red);
    const Image image = resolve_samples(canvas);
    EXPECT_EQ(count(image, red), 16);
    EXPECT_EQ(count(image, blue), 12);
  }
}

TEST(RasterImage, IntersectingTrianglesAreEachVisibleWhereTheyAreNearer) {
  Canvas canvas(20, 10, white);
  Points3 x(8, 3);
  x << 0, 0, 0, 20, 0, 20, 20, 10, 20, 0, 10, 0,  // rises to the right
      0, 0, 20, 20, 0, 0, 20, 10, 0, 0, 10, 20;   // falls
  Triangles triangles(4, 3);
  triangles << 0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7;
  draw_triangles(canvas, plain_camera(10), x, triangles, {red, red, blue, blue});
  const Image image = resolve_samples(canvas);
  EXPECT_EQ(count(image, red), 100);
  EXPECT_EQ(count(image, blue), 100);
  EXPECT_EQ(image.at(0, 5), blue);
  EXPECT_EQ(image.at(19, 5), red);
}

TEST(RasterImage, LinesAndDiscsHaveTheirWidthAtAnySlope) {
  for (const double angle : {0.0, 0.3, 0.8, 1.5}) {
    Canvas canvas(120, 120, white);
    const Vector3d middle(60, 60, 0), along(40 * std::cos(angle), 40 * std::sin(angle), 0);
    draw_line(canvas, plain_camera(120), middle - along, middle + along, {2, black});
    // half a width beyond both ends
    EXPECT_NEAR(blackened(resolve_samples(canvas)) / (2 * 82), 1, 0.03) << angle;
  }
  Canvas canvas(40, 40, white);
  draw_disc(canvas, plain_camera(40), {20, 20, 0}, 10, black);
  EXPECT_NEAR(blackened(resolve_samples(canvas)) / (M_PI * 100), 1, 0.01);
}

TEST(RasterImage, ALineOnASurfaceIsHiddenWithTheSurface) {
  Canvas canvas(20, 10, white);
  draw_square(canvas, 0, 0, 10, 0, red);
  draw_square(canvas, 10, 0, 10, 5, blue);
  draw_line(canvas, plain_camera(10), {0, 5, 0}, {20, 5, 0}, {2, black, /*lift=*/1});
  const Image image = resolve_samples(canvas);
  EXPECT_EQ(image.at(5, 5), black);
  EXPECT_EQ(image.at(15, 5), blue);
}

TEST(RasterImage, ShapesPartlyOutsideTheImageAreClipped) {
  Canvas canvas(10, 10, white);
  draw_square(canvas, -1e6, -1e6, 1e6 + 5, 0, black);
  draw_disc(canvas, plain_camera(10), {100, 100, 0}, 5, black);
  draw_text(canvas, -3, 8, 1, "outside", black);
  EXPECT_EQ(resolve_samples(canvas).at(0, 9), black);
  EXPECT_EQ(resolve_samples(canvas).at(9, 0), white);
}

TEST(RasterImage, AFittedCameraSeesAllPointsAndFillsTheViewport) {
  const Sheet sheet = test::hex_sheet(0.3, 0.1, 10);
  const Viewport frame{20, 40, 300, 200};
  const Camera camera = fit_camera(sheet.x, {-0.6, -1, 0.7}, frame);
  Eigen::AlignedBox2d seen;
  for (int v = 0; v < sheet.x.rows(); ++v)
    seen.extend(Vector2d(camera.project(sheet.x.row(v)).head<2>()));
  EXPECT_NEAR(seen.min().x(), 20, 1e-9);
  EXPECT_NEAR(seen.max().x(), 320, 1e-9);
  EXPECT_GT(seen.min().y(), 40);
  EXPECT_LT(seen.max().y(), 240);
  EXPECT_GT(camera.up.z(), 0.5);
  EXPECT_GT(camera.project({0, -1, 0}).z(), camera.project({0, 1, 0}).z()) << "the front is nearer";
}

TEST(RasterImage, LettersAreReadable) {
  Canvas canvas(6, 7, white, 1);
  draw_text(canvas, 0, 0, 1, "F", black);
  const Image image = resolve_samples(canvas);
  const char* expected[] = {"#####.", "#.....", "#.....", "####..", "#.....", "#.....", "#....."};
  for (int row = 0; row < 7; ++row)
    for (int column = 0; column < 6; ++column)
      EXPECT_EQ(image.at(column, row), expected[row][column] == '#' ? black : white)
          << row << " " << column;
  EXPECT_EQ(text_width("F", 1), 5);
}

class RasterImageFile : public testing::Test {
 protected:
  void SetUp() override {
    folder = fs::path(testing::TempDir()) /
             testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }

  static Image coloured() {
    Canvas canvas(31, 17, white);
    draw_square(canvas, 3.4, 2.2, 9.7, 0, red);
    draw_square(canvas, 8.1, 5.5, 20, 1, blue);
    return resolve_samples(canvas);
  }
  static std::string bytes_in(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  fs::path folder;
};

TEST_F(RasterImageFile, IsReadBackAsItWasWritten) {
  const Image image = coloured();
  write_png(folder / "a.png", image);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_file(&png, (folder / "a.png").c_str())) << png.message;
  ASSERT_EQ(int(png.width), image.width);
  ASSERT_EQ(int(png.height), image.height);
  png.format = PNG_FORMAT_RGB;
  std::vector<Colour> read(image.pixels.size());
  ASSERT_TRUE(png_image_finish_read(&png, nullptr, read.data(), 0, nullptr)) << png.message;
  EXPECT_TRUE(read == image.pixels);
  EXPECT_GT(count(image, red), 10);
}

TEST_F(RasterImageFile, TheSameImageGivesTheSameBytesWithoutADate) {
  write_png(folder / "a.png", coloured());
  write_png(folder / "b.png", coloured());
  const std::string bytes = bytes_in(folder / "a.png");
  ASSERT_GT(bytes.size(), 100u);
  EXPECT_EQ(bytes, bytes_in(folder / "b.png"));
  for (const char* chunk : {"tIME", "tEXt", "zTXt", "iTXt", "eXIf"})
    EXPECT_EQ(bytes.find(chunk), std::string::npos) << chunk;
}

TEST_F(RasterImageFile, AMissingFolderIsAFolderError) {
  try {
    write_png(folder / "missing" / "a.png", coloured());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ErrorCode::folder);
    EXPECT_NE(std::string(error.what()).find("a.png"), std::string::npos);
  }
}

}  // namespace
}  // namespace paperbake
