#include "baker/bake/bake_certificate.h"

#include "tests/core/test_meshes.h"
#include "tests/core/test_shots.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace paperbake {
namespace {

BakePlan two_sheets() {
  BakePlan plan;
  for (const char* name : {"left", "right"}) {
    plan.shots.push_back(test::blank_shot(test::rectangle(0.1, 0.1)));
    plan.shots.back().sheet_name = name;
  }
  return plan;
}

FrameRecord record_of(const BakePlan& plan, std::size_t sheet, int frame) {
  FrameRecord record;
  record.frame = frame;
  record.sheet = plan.shots[sheet].sheet_name;
  record.content_hash = record.sheet + std::to_string(frame);
  return record;
}

TEST(BakeCertificateTest, LinesAreFoundBySheetAndFrameInWhateverOrderTheyCame) {
  const BakePlan plan = two_sheets();
  BakeCertificate certificate(plan);
  for (const std::size_t sheet : {0, 1})  // polished, one sheet comes after the other
    for (const int frame : {1, 2, 3}) certificate.add_line(sheet, record_of(plan, sheet, frame));
  EXPECT_EQ(certificate.line(1, 2).content_hash, "right2");
  EXPECT_EQ(certificate.line(0, 3).content_hash, "left3");
  EXPECT_EQ(certificate.lines_of_sheets(), (std::vector<std::size_t>{3, 3}));
}

TEST(BakeCertificateTest, FinishedItIsSortedByFrameAndNamesOnlyFramesThatTheCacheHas) {
  const BakePlan plan = two_sheets();
  BakeCertificate certificate(plan);
  for (const std::size_t sheet : {0, 1})
    for (const int frame : {1, 2, 3}) certificate.add_line(sheet, record_of(plan, sheet, frame));
  certificate.singular = {{"right", {}}, {"left", {}}};
  certificate.finalize({3, 2});
  std::vector<std::string> hashes;
  for (const FrameRecord& line : certificate.frames()) hashes.push_back(line.content_hash);
  EXPECT_EQ(hashes, (std::vector<std::string>{"left1", "right1", "left2", "right2", "left3", ""}));
  EXPECT_EQ(certificate.singular.front().sheet, "left");
}

}  // namespace
}  // namespace paperbake
