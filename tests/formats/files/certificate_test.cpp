#include "formats/files/certificate.h"

#include "core/model/error.h"
#include "formats/files/frame_statistics_table.h"
#include "tests/formats/files/frame_keys.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

namespace paperbake {
namespace {

const double nan = std::numeric_limits<double>::quiet_NaN();

/// Another value for every number.
FrameStatistics distinct_statistics() {
  FrameStatistics statistics;
  statistics.render.emplace();
  int next = 3;
  visit_frame_statistics([&](const auto& field) {
    using Value = typename std::decay_t<decltype(field)>::Value;
    Value& value = *find_statistic(statistics, field);
    if constexpr (std::is_same_v<Value, bool>)
      value = !value;
    else if constexpr (std::is_floating_point_v<Value>)
      value = ++next + 1.0 / 3;  // 17 digits are needed
    else
      value = static_cast<Value>(++next);
  });
  return statistics;
}

FrameRecord full_record() {
  FrameRecord r;
  r.frame = 37;
  r.sheet = "paper_A";
  r.statistics = distinct_statistics();
  r.worst = {{0.125, 0.0625}, {0.1, 0.2}, "collider \"A\""};
  r.jammed = {{"handle_a", 1.25}, {"handle_b", 2.0 / 3, "handle_a"}};
  r.note = "a snap";
  r.input_hash = "00ff";
  r.content_hash = "ff00";
  return r;
}

TEST(Certificate, AFrameLineHasItsKeysInTheDocumentedOrder) {
  const auto line = nlohmann::ordered_json::parse(frame_line(full_record()));
  std::vector<std::string> keys;
  for (const auto& item : line.items()) keys.push_back(item.key());
  EXPECT_EQ(keys, test::frame_keys);
}

TEST(Certificate, EveryFieldOfAFrameLineReadsBackAsItWas) {
  const FrameRecord r = full_record();
  const std::string text = frame_line(r);
  EXPECT_EQ(text.find('\n'), std::string::npos);
  const std::optional<FrameRecord> read = parse_frame_line(text);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->frame, 37);
  EXPECT_EQ(read->sheet, "paper_A");
  ASSERT_TRUE(read->statistics.render.has_value());
  int named = 0;
  visit_frame_statistics([&](const auto& field) {
    if (!field.name) return;
    ++named;
    EXPECT_DOUBLE_EQ(static_cast<double>(*find_statistic(read->statistics, field)),
                     static_cast<double>(*find_statistic(r.statistics, field)))
        << field.name;
  });
  EXPECT_GT(named, 20);
  ASSERT_EQ(read->jammed.size(), 2u);
  EXPECT_EQ(read->jammed[1].handle, "handle_b");
  EXPECT_EQ(read->jammed[1].off_mm, 2.0 / 3);
  EXPECT_EQ(read->jammed[1].taut_to, "handle_a");
  EXPECT_EQ(read->jammed[0].taut_to, "");
  EXPECT_LT((read->worst.stretch_at - r.worst.stretch_at).norm(), 1e-15);
  EXPECT_LT((read->worst.inside_at - r.worst.inside_at).norm(), 1e-15);
  EXPECT_EQ(read->worst.inside_of, "collider \"A\"");
  EXPECT_EQ(read->note, "a snap");
  EXPECT_EQ(read->input_hash, "00ff");
  EXPECT_EQ(read->content_hash, "ff00");
}

TEST(Certificate, NumbersAreGivenInTheUnitOfTheirNameWithAllTheirDigits) {
  FrameRecord r;
  r.statistics.stretch_mean = (0.1 + 0.2) / 100;
  r.statistics.angle_defect_max = M_PI / 8;
  r.statistics.handle_error_max = 4e-16;
  r.statistics.inside = 2.5e-3;
  r.statistics.energy = 1.7e-5;
  const auto line = nlohmann::json::parse(frame_line(r));
  EXPECT_EQ(line["stretch_mean_pct"].get<double>(), 100 * r.statistics.stretch_mean);
  EXPECT_EQ(line["angle_defect_max_deg"], 22.5);
  EXPECT_EQ(line["handle_err_max_mm"].get<double>(), 1e3 * 4e-16);
  EXPECT_EQ(line["inside_mm"], 2.5);
  EXPECT_EQ(line["energy_J"].get<double>(), 1.7e-5);
}

TEST(Certificate, ALineOfAnOlderVersionReadsAsFarAsItGoes) {
  auto line = nlohmann::json::parse(frame_line(full_record()));
  line.erase("touching_others");
  const auto read = parse_frame_line(line.dump());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->statistics.touching_others, 0);
  EXPECT_EQ(read->statistics.touching, full_record().statistics.touching);
  line.erase("sheet");
  EXPECT_FALSE(parse_frame_line(line.dump()));
}

TEST(Certificate, TextThatIsNoFrameLineIsNotRead) {
  for (const char* text : {"", "x", "[]", "{}", "{\"frame\":\"one\"}"})
    EXPECT_FALSE(parse_frame_line(text)) << text;
}

TEST(Certificate, NoHandleJammedIsAnEmptyList) {
  FrameRecord r;
  EXPECT_TRUE(nlohmann::json::parse(frame_line(r))["jammed"].is_array());
  EXPECT_TRUE(nlohmann::json::parse(frame_line(r))["jammed"].empty());
  r.jammed = {{"only", 1}};  // a single pair must still be a list of lists
  EXPECT_EQ(nlohmann::json::parse(frame_line(r))["jammed"].dump(), "[[\"only\",1.0]]");
}

TEST(Certificate, ANonFiniteNumberIsAnErrorNamingFrameAndField) {
  for (const double value : {nan, HUGE_VAL, -HUGE_VAL}) {
    FrameRecord r = full_record();
    r.statistics.energy = value;
    try {
      frame_line(r);
      FAIL() << "accepted " << value;
    } catch (const Error& error) {
      EXPECT_EQ(error.code, ErrorCode::simulation);
      EXPECT_EQ(error.place, "frame 37, sheet \"paper_A\"");
      EXPECT_NE(error.cause.find("energy_J"), std::string::npos);
    }
  }
  FrameRecord r = full_record();
  r.jammed[1].off_mm = nan;
  EXPECT_THROW(frame_line(r), Error);
  HandleRecord handle;
  handle.held.y() = nan;
  EXPECT_THROW(handles_csv({handle}), Error);
  EXPECT_THROW(singular_csv({{"s", {Vector2d(0, nan), 1, "c"}}}), Error);
}

TEST(Certificate, ANameThatIsNotUtf8DoesNotStopTheBake) {
  FrameRecord r = full_record();
  r.sheet = "pap\xE9r";  // Latin-1
  EXPECT_EQ(nlohmann::json::parse(frame_line(r))["sheet"], "pap\xEF\xBF\xBDr");
}

TEST(Certificate, HandleRowsHaveTheExactHeader) {
  HandleRecord r;
  r.frame = 5;
  r.sheet = "paper";
  r.handle = "corner";
  r.pattern = {0.125, 0.1};
  r.keyed = {1.0 / 3, -2, 1e-9};
  r.held = {0.3, -0.0, 3};
  HandleRecord free = r, soft = r, jammed = r;
  free.state = HandleFrame::free;
  soft.state = HandleFrame::soft;
  jammed.state = HandleFrame::jammed;
  const std::string numbers = "0.125,0.1,0.3333333333333333,-2,1e-09,0.3,0,3,";
  EXPECT_EQ(handles_csv({r, free, soft, jammed}),
            "frame,sheet,handle,u,v,keyed_x,keyed_y,keyed_z,held_x,held_y,held_z,state\n"
            "5,paper,corner," +
                numbers +
                "held\n"
                "5,paper,corner," +
                numbers +
                "free\n"
                "5,paper,corner," +
                numbers +
                "soft\n"
                "5,paper,corner," +
                numbers + "jammed\n");
  const std::vector<HandleRecord> again = parse_handles_csv(handles_csv({r, free, soft, jammed}));
  ASSERT_EQ(again.size(), 4U);
  EXPECT_EQ(again[2].state, HandleFrame::soft);
  EXPECT_EQ(again[3].state, HandleFrame::jammed);
}

TEST(Certificate, NamesWithCommasQuotesAndLineEndsAreQuoted) {
  HandleRecord r;
  r.sheet = "a,b";
  r.handle = "say \"hi\"\nthere";
  const std::string csv = handles_csv({r});
  EXPECT_NE(csv.find("\n0,\"a,b\",\"say \"\"hi\"\"\nthere\",0,0,"), std::string::npos) << csv;
}

TEST(Certificate, AFrameThatWasNotRenderedHasNoRenderNumbers) {
  FrameRecord r = full_record();
  r.statistics.render.reset();
  const auto line = nlohmann::json::parse(frame_line(r));
  for (const char* key : {"render_triangles", "render_stretch_mean_pct", "render_stretch_max_pct",
                          "render_ms", "render_crossings", "render_crossings_with_others"})
    EXPECT_TRUE(line.at(key).is_null()) << key;
  EXPECT_EQ(line["triangles"], r.statistics.triangles);
  EXPECT_FALSE(parse_frame_line(frame_line(r))->statistics.render);
}

TEST(Certificate, SingularRowsAreInOrderOfBirthAndNumberedAsTheMapsOfTheirSheet) {
  const std::vector<SingularRecord> records = {
      {"A", {Vector2d(0.05, 0.005), 35, "conflict, first"}},
      {"A", {Vector2d(0.02, 0.03), 60, "conflict"}},
      {"B", {Vector2d(0.01, 0.02), 35, "buckling"}}};
  EXPECT_EQ(singular_csv(records),
            "id,sheet,frame,u,v,cause\n"
            "1,A,35,0.05,0.005,\"conflict, first\"\n"
            "1,B,35,0.01,0.02,buckling\n"
            "2,A,60,0.02,0.03,conflict\n");
}

TEST(Certificate, WithoutRecordsThereIsOnlyTheHeader) {
  EXPECT_EQ(handles_csv({}),
            "frame,sheet,handle,u,v,keyed_x,keyed_y,keyed_z,held_x,held_y,held_z,state\n");
  EXPECT_EQ(singular_csv({}), "id,sheet,frame,u,v,cause\n");
}

TEST(Certificate, DamagedHandleRowsAreRefused) {
  const std::string
      head = "frame,sheet,handle,u,v,keyed_x,keyed_y,keyed_z,held_x,held_y,held_z,state\n",
      rest = ",paper,corner,0,0,0,0,0,0,0,0,";
  ASSERT_EQ(parse_handles_csv(head + "-7" + rest + "held\n").at(0).frame, -7);
  for (const std::string& row :
       {"1e300" + rest + "held", "2147483648" + rest + "held", "x" + rest + "held",
        "1" + rest + "lost", std::string("1,paper"), "1" + rest + "held,"})
    try {
      parse_handles_csv(head + row + "\n");
      ADD_FAILURE() << row;
    } catch (const Error& error) {
      EXPECT_EQ(error.place, "handles.csv, row 2") << row;
    }
}

}  // namespace
}  // namespace paperbake
