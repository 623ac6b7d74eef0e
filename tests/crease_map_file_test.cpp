// The file of a crease map: its channels and header, its bytes, and disks that do not take it.

#include "formats/crease_map.h"

#include "core/curvature.h"
#include "core/error.h"
#include "tests/crease_map_fixture.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfRationalAttribute.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/resource.h>
#include <vector>

namespace paperbake {
namespace {

using test::flat_sheet;
using test::Folder;
using test::fold_width;
using test::rectangle;
using test::rolled;

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

}  // namespace
}  // namespace paperbake
