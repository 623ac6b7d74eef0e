#include "baker/job/output_formats.h"

#include "baker/job/options.h"
#include "baker/output/frame_writer.h"
#include "core/model/error.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace paperbake {
namespace {

TEST(OutputFormatsTest, TheOptionKnowsEveryFormatOfTheTableAndDescribesIt) {
  const Option& formats = option("formats");
  std::string all;
  for (const OutputFormat& format : output_formats()) {
    EXPECT_NE(formats.help.find(format.name + " (" + format.what + ")"), std::string::npos)
        << formats.help;
    all += (all.empty() ? "" : ",") + format.name;
    BakeSettings settings;
    apply_option(settings, formats, format.name, "--formats", Origin::command);
    EXPECT_EQ(settings.formats, std::set<std::string>{format.name});
    EXPECT_EQ(has_frames(settings.formats), format.has_frames);
  }
  EXPECT_EQ(all, "abc,maps,cert,report,usd,usdc,pc2,preview");
  BakeSettings settings;
  EXPECT_THROW(apply_option(settings, formats, "abc,gif", "--formats", Origin::command), Error);
}

TEST(OutputFormatsTest, AWriterIsKnownForThoseThatHaveFramesAndForNoOthers) {
  for (const OutputFormat& format : output_formats())
    EXPECT_EQ(maker_of_writer(format.name) != nullptr, format.has_frames) << format.name;
  EXPECT_EQ(maker_of_writer("gif"), nullptr);
}

TEST(OutputFormatsTest, TheDefaultOfTheOptionIsThatOfTheSettings) {
  const BakeSettings untouched;
  EXPECT_EQ(untouched.formats, (std::set<std::string>{"abc", "maps", "cert", "report"}));
  BakeSettings settings;
  apply_option(settings, option("formats"), option("formats").default_value, "--formats",
               Origin::command);
  EXPECT_EQ(settings.formats, untouched.formats);
}

TEST(OutputFormatsTest, OnlyFilesInAFolderOfTheirOwnHaveOne) {
  for (const OutputFormat& format : output_formats())
    EXPECT_EQ(format.folder(),
              format.name == "maps" || format.name == "cert" ? format.name : std::string())
        << format.file;
}

}  // namespace
}  // namespace paperbake
