// The file of a crease map: channels, header, bytes, mip-map levels, and errors of the disk.

#include "formats/maps/map_file.h"

#include "core/geometry/curvature.h"
#include "core/model/error.h"
#include "tests/formats/maps/crease_map_fixture.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfRationalAttribute.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfTileDescriptionAttribute.h>
#include <ImfTiledInputFile.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace paperbake {
namespace {

using test::flat_sheet;
using test::folded_sheet;
using test::Folder;
using test::frame_buffer;
using test::Image;
using test::of_size;
using test::read_image;
using test::rectangle;
using test::rolled;

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(MapFile, TheFileHasItsSixteenLayersAndItsHeaderAndNothingElse) {
  const Folder folder;
  for (const MapLayout layout : {MapLayout::scanline, MapLayout::tiled_mip}) {
    CreaseMapOptions options = of_size(64);
    options.layout = layout;
    CreaseMap map(rectangle(0.2, 0.1), options);
    const Sheet sheet = flat_sheet(0.2, 0.1, 0.02);
    map.record(1, sheet, vertex_curvature(sheet));
    map.write(folder.path / "map.exr", {37, 29.97, 4000000000u, "copy90"});

    Imf::InputFile file((folder.path / "map.exr").c_str());
    const Imf::Header& header = file.header();
    std::map<std::string, Imf::PixelType> channels;
    std::vector<std::string> attributes;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
      channels[c.name()] = c.channel().type;
    for (auto a = header.begin(); a != header.end(); ++a) attributes.push_back(a.name());
    std::sort(attributes.begin(), attributes.end());
    EXPECT_EQ(channels, (std::map<std::string, Imf::PixelType>{{"R", Imf::HALF},
                                                               {"G", Imf::HALF},
                                                               {"B", Imf::HALF},
                                                               {"A", Imf::HALF},
                                                               {"fold.angle", Imf::HALF},
                                                               {"fold.plastic", Imf::HALF},
                                                               {"fold.peak", Imf::HALF},
                                                               {"age.crease", Imf::HALF},
                                                               {"age.apex", Imf::HALF},
                                                               {"apex.dist", Imf::HALF},
                                                               {"apex.id", Imf::UINT},
                                                               {"apex.cone", Imf::HALF},
                                                               {"dir.x", Imf::HALF},
                                                               {"dir.y", Imf::HALF},
                                                               {"strain.min", Imf::HALF},
                                                               {"strain.max", Imf::HALF}}));
    std::vector<std::string> expected{"channels",
                                      "compression",
                                      "creaseWidth",
                                      "dataWindow",
                                      "displayWindow",
                                      "foldWidth",
                                      "frame",
                                      "framesPerSecond",
                                      "lineOrder",
                                      "pixelAspectRatio",
                                      "preset",
                                      "screenWindowCenter",
                                      "screenWindowWidth",
                                      "seed",
                                      "texelSize"};
    if (layout == MapLayout::tiled_mip) expected.push_back("tiles");
    expected.push_back("type");
    EXPECT_EQ(attributes, expected);
    EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
    EXPECT_EQ(header.typedAttribute<Imf::IntAttribute>("frame").value(), 37);
    EXPECT_EQ(static_cast<unsigned>(header.typedAttribute<Imf::IntAttribute>("seed").value()),
              4000000000u);
    EXPECT_EQ(header.typedAttribute<Imf::StringAttribute>("preset").value(), "copy90");
    EXPECT_EQ(header.typedAttribute<Imf::RationalAttribute>("framesPerSecond").value().n, 30000);
    EXPECT_EQ(header.typedAttribute<Imf::RationalAttribute>("framesPerSecond").value().d, 1001u);
    EXPECT_FLOAT_EQ(header.typedAttribute<Imf::FloatAttribute>("texelSize").value(), 0.2f / 64);
    EXPECT_FLOAT_EQ(header.typedAttribute<Imf::FloatAttribute>("foldWidth").value(), 0.002f);
    EXPECT_FLOAT_EQ(header.typedAttribute<Imf::FloatAttribute>("creaseWidth").value(), 0.0005f);
  }
}

/// A sheet that shows on every layer.
Sheet busy_sheet() {
  Sheet sheet = folded_sheet(0.1, 0.1, 0.03, 0.06, 1.2);
  sheet.singular = {{Vector2d(0.03, 0.04), 1, "a"}, {Vector2d(0.071, 0.08), 1, "b"}};
  return sheet;
}

TEST(MapFile, TheSameInputGivesTheSameBytesAtAnyThreadCount) {
  const Folder folder;
  const Sheet sheet = busy_sheet();
  for (const MapLayout layout : {MapLayout::scanline, MapLayout::tiled_mip}) {
    std::string bytes[3];
    for (int run = 0; run < 3; ++run) {
      CreaseMapOptions options = of_size(300);
      options.layout = layout;
      options.threads = run + 1;
      CreaseMap map(rectangle(0.1, 0.1), options);
      map.record(1, sheet, vertex_curvature(sheet));
      const std::filesystem::path path = folder.path / (std::to_string(run) + ".exr");
      map.write(path, {});
      bytes[run] = bytes_of(path);
    }
    ASSERT_GT(bytes[0].size(), 1000u);
    EXPECT_EQ(bytes[0], bytes[1]);
    EXPECT_EQ(bytes[0], bytes[2]);
  }
  Imf::setGlobalThreadCount(0);
}

TEST(MapFile, ChunksAreWhatWasDrawnWhetherTheyAreLikeTheOneBeforeOrNot) {
  const Folder folder;
  const auto strength = [](int row) { return row / 16 == 3 || row / 16 == 5 ? 0.5f : 0.25f; };
  for (const int threads : {1, 2}) {
    const std::string bytes = encode_map(128, MapLayout::scanline, {}, {}, threads,
                                         [&](const MapRows& rows, MapTexel* texels) {
                                           for (int row = rows.first; row < rows.last; ++row)
                                             for (int i = 0; i < rows.size; ++i) {
                                               texels[rows.index(i, row)] = MapTexel{};
                                               texels[rows.index(i, row)].r = strength(row);
                                             }
                                         });
    std::ofstream(folder.path / "map.exr", std::ios::binary) << bytes;
    const Image image = read_image(folder.path / "map.exr");
    for (int row = 0; row < 128; ++row)
      for (int i = 0; i < 128; ++i) ASSERT_EQ(image.at(i, row).r, strength(row)) << row;
  }
}

TEST(MapFile, TheLevelsOfATiledMapAreHalvedAndTheFirstIsTheScanlineMap) {
  const Folder folder;
  const Sheet sheet = busy_sheet();
  std::vector<Image> levels;
  Image scanline;
  for (const MapLayout layout : {MapLayout::scanline, MapLayout::tiled_mip}) {
    // not a power of two: levels of 150, 75, 37, 18, 9, 4, 2, 1
    CreaseMapOptions options = of_size(300);
    options.layout = layout;
    CreaseMap map(rectangle(0.1, 0.1), options);
    map.record(1, sheet, vertex_curvature(sheet));
    map.write(folder.path / "map.exr", {1, 24, 0, ""});
    if (layout == MapLayout::scanline) {
      scanline = read_image(folder.path / "map.exr");
      continue;
    }
    Imf::TiledInputFile file((folder.path / "map.exr").c_str());
    EXPECT_EQ(file.tileXSize(), 64u);
    EXPECT_EQ(file.levelMode(), Imf::MIPMAP_LEVELS);
    ASSERT_EQ(file.numLevels(), 9);
    for (int l = 0; l < file.numLevels(); ++l) {
      Image image{file.levelWidth(l), {}};
      EXPECT_EQ(image.size, 300 >> l);
      file.setFrameBuffer(frame_buffer(image));
      file.readTiles(0, file.numXTiles(l) - 1, 0, file.numYTiles(l) - 1, l);
      levels.push_back(std::move(image));
    }
  }
  for (std::size_t t = 0; t < scanline.texels.size(); ++t) {
    ASSERT_EQ(levels[0].texels[t].r, scanline.texels[t].r);
    ASSERT_EQ(levels[0].texels[t].fold_angle, scanline.texels[t].fold_angle);
    ASSERT_EQ(levels[0].texels[t].apex_id, scanline.texels[t].apex_id);
  }
  const auto mean = [](const Image& image) {
    double sum = 0;
    for (const MapTexel& t : image.texels) sum += t.r;
    return sum / image.texels.size();
  };
  ASSERT_GT(mean(levels[0]), 0.003);
  for (const Image& level : levels) {
    EXPECT_NEAR(mean(level), mean(levels[0]), 0.003 * mean(levels[0]))
        << level.size;  // rounding of HALF
    for (const MapTexel& t : level.texels) {
      ASSERT_TRUE(t.apex_id == 1 || t.apex_id == 2);
      ASSERT_EQ(t.a, 1);
    }
  }
}

TEST(MapFile, ALevelIsTheMeanOfTheCoveredTexelsAndIdsAreNotAveraged) {
  std::vector<MapTexel> four(4);
  four[0].a = 1.0f;
  four[0].r = 1.0f;
  four[0].fold_angle = 0.3f;
  four[0].apex_id = 7;
  four[0].dir_x = 0;
  four[0].dir_y = 1;
  four[1].a = 0.5f;
  four[1].r = 0.0f;
  four[1].fold_angle = 0.6f;
  four[1].apex_id = 9;
  four[1].dir_x = 0;
  four[1].dir_y = -1;
  four[0].age_crease = 2;
  four[2].r = 1.0f;
  four[2].fold_angle = 99;
  four[2].apex_id = 11;  // padding: not covered
  const std::vector<MapTexel> one = next_level(four, 2, 1);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_FLOAT_EQ(one[0].a, 0.375f);
  EXPECT_NEAR(one[0].r, 2.0 / 3, 1e-3);
  EXPECT_NEAR(one[0].fold_angle, 0.4, 0.4 / 2048);  // in 16 bits
  EXPECT_EQ(one[0].apex_id,
            7u);  // of the texel with most paper, since the one at the centre has none
  EXPECT_EQ(one[0].age_crease, 2);
  EXPECT_NEAR(std::abs(one[0].dir_y), 1, 1e-6);  // up and down are the same ruling
}

TEST(MapFile, TexelsOfAnOddSideAreWeightedByArea) {
  std::vector<MapTexel> row(9);
  // the middle column
  for (int t = 0; t < 9; ++t) {
    row[t].a = 1.0f;
    row[t].strain_max = t % 3 == 1 ? 3.0f : 0.0f;
  }
  const std::vector<MapTexel> one = next_level(row, 3, 2);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_FLOAT_EQ(one[0].strain_max, 1);
  std::vector<MapTexel> five(25);
  for (int t = 0; t < 25; ++t) {
    five[t].a = 1.0f;
    five[t].strain_max = t % 5 == 2 ? 1.0f : 0.0f;
  }
  // half a texel out of 2.5
  for (const MapTexel& t : next_level(five, 5, 1)) EXPECT_NEAR(t.strain_max, 0.2, 0.2 / 2048);
}

TEST(MapFile, ABigMapIsDrawnAndPackedInTime) {
  Sheet sheet = rolled(flat_sheet(0.21, 0.21, 0.007), 30);  // 1,800 triangles
  for (int k = 0; k < 40; ++k)
    sheet.singular.push_back(
        {Vector2d(std::fmod(0.0173 * k, 0.21), std::fmod(0.0291 * k, 0.21)), 1, "a"});
  const Folder folder;
  for (const MapLayout layout : {MapLayout::scanline, MapLayout::tiled_mip}) {
    CreaseMapOptions options = of_size(2048);
    options.layout = layout;
    options.threads = 2;
    options.thresholds.yield_curvature = 5;
    CreaseMap map(rectangle(0.21, 0.21), options);
    map.record(1, sheet, vertex_curvature(sheet), vertex_curvature(sheet));
    const auto cpu = std::clock();
    const auto wall = std::chrono::steady_clock::now();
    map.write(folder.path / "map.exr", {});
    const double seconds = double(std::clock() - cpu) / CLOCKS_PER_SEC;
    std::printf("%s 2048: %.2f s of all threads, %.2f s by the clock, %.1f MB\n",
                layout == MapLayout::scanline ? "scanline" : "tiled-mip", seconds,
                std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count(),
                1e-6 * std::filesystem::file_size(folder.path / "map.exr"));
    // CPU time: 2 s on two cores; an idle machine needs half of that
    if (layout == MapLayout::scanline) {
      EXPECT_LT(seconds, 4);
    }
  }
  Imf::setGlobalThreadCount(0);
}

TEST(MapFile, AMissingFolderIsAFolderError) {
  const Folder folder;
  CreaseMap map(rectangle(0.1, 0.1), of_size(16));
  try {
    map.write(folder.path / "missing" / "map.exr", {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ErrorCode::folder);
    EXPECT_NE(error.place.find("map.exr"), std::string::npos);
  }
}

TEST(MapFile, AFullDiskIsAFolderErrorAndLeavesNoFile) {
  const Folder folder;
  // the map of a flat sheet is so small that it stays in a buffer until the file is closed, where
  // errors are easily missed
  CreaseMap map(rectangle(0.1, 0.1), of_size(64));
  const Sheet sheet = flat_sheet(0.1, 0.1, 0.01);
  map.record(1, sheet, vertex_curvature(sheet));
  map.write(folder.path / "map.exr", {});
  ASSERT_GT(std::filesystem::remove_all(folder.path / "map.exr"), 0u);

  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{512, before.rlim_max};  // simulates a disk with 512 bytes left
  const auto old = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  bool folder_error = false;
  try {
    map.write(folder.path / "map.exr", {});
  } catch (const Error& error) {
    folder_error = error.code == ErrorCode::folder;
  }
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old);
  EXPECT_TRUE(folder_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

}  // namespace
}  // namespace paperbake
