#include "formats/config/preset_file.h"

#include "core/model/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace paperbake {
namespace {

/// The text of a preset with one passage replaced, as a file that is deleted at the end of the
/// test.
struct PresetFile {
  std::string path, text;
  PresetFile(const std::string& from = "", const std::string& to = "") {
    text = read_preset("copy70").text;
    if (!from.empty()) {
      const std::size_t at = text.find(from);
      EXPECT_NE(at, std::string::npos) << from;
      text.replace(at, from.size(), to);
    }
    path = (std::filesystem::temp_directory_path() /
            (std::string("paperbake_") +
             testing::UnitTest::GetInstance()->current_test_info()->name() + ".toml"))
               .string();
    std::ofstream(path, std::ios::binary) << text;
  }
  ~PresetFile() { std::filesystem::remove(path); }

  /// "line:column" of the first character of `what` in the file
  std::string place(const std::string& what) const {
    const std::size_t at = text.find(what), line_start = text.rfind('\n', at) + 1;
    return path + ":" + std::to_string(1 + std::count(text.begin(), text.begin() + at, '\n')) +
           ":" + std::to_string(1 + at - line_start);
  }
};

/// The error of reading a preset; fails the test when there is none.
Error error_of(const std::string& name_or_file) {
  try {
    read_preset(name_or_file);
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ErrorCode::command);
    return error;
  }
  ADD_FAILURE() << name_or_file << " was read without an error";
  return Error(ErrorCode::command, "", "");
}

TEST(PresetFile, TheBuiltInGradesHaveTheDocumentedValues) {
  const Paper light = read_preset("copy70").paper, heavy = read_preset("copy90").paper;
  EXPECT_EQ(light.name, "copy70");
  EXPECT_EQ(light.thickness, 90e-6);
  EXPECT_EQ(light.bending_stiffness, 2.7e-4);
  EXPECT_EQ(light.membrane_stiffness, 3.6e5);
  EXPECT_EQ(light.poisson, 0.3);
  EXPECT_EQ(light.area_density, 0.070);
  EXPECT_EQ(light.apex_scatter, 0.005);
  EXPECT_EQ(light.yield_strain, 0.0045);
  EXPECT_EQ(light.hardening, 0.3);
  EXPECT_EQ(heavy.name, "copy90");
  EXPECT_EQ(heavy.thickness, 104e-6);
  EXPECT_EQ(heavy.bending_stiffness, 4.1e-4);
  EXPECT_EQ(heavy.membrane_stiffness, 4.2e5);
  EXPECT_EQ(heavy.area_density, 0.090);
  EXPECT_EQ(heavy.yield_strain, 0.0045);
  EXPECT_EQ(heavy.hardening, 0.3);
}

TEST(PresetFile, TheDefaultPaperOfTheCoreIsCopy70) {
  const Paper file = read_preset("copy70").paper, core;
  EXPECT_EQ(file.name, core.name);
  EXPECT_EQ(file.thickness, core.thickness);
  EXPECT_EQ(file.bending_stiffness, core.bending_stiffness);
  EXPECT_EQ(file.membrane_stiffness, core.membrane_stiffness);
  EXPECT_EQ(file.poisson, core.poisson);
  EXPECT_EQ(file.area_density, core.area_density);
  EXPECT_EQ(file.apex_scatter, core.apex_scatter);
  EXPECT_EQ(file.yield_strain, core.yield_strain);
  EXPECT_EQ(file.hardening, core.hardening);
  // layers slide freely in the core unless a grade says how they rub
  EXPECT_EQ(core.friction, 0);
  EXPECT_EQ(file.friction, 0.45);
}

TEST(PresetFile, EveryBuiltInGradeAgreesWithThePlateFormula) {
  // D = (E h) h^2 / 12(1-nu^2) shows an error in any of the numbers; 3 % since they have two digits
  ASSERT_EQ(preset_names(),
            (std::vector<std::string>{"book120", "card200", "card300", "copy70", "copy80", "copy90",
                                      "kami63", "kraft90", "newsprint45", "offset160", "tissue17",
                                      "tracing92", "washi35"}));
  for (const std::string& name : preset_names()) {
    const Paper p = read_preset(name).paper;
    EXPECT_EQ(p.name, name);
    const double D =
        p.membrane_stiffness * p.thickness * p.thickness / (12 * (1 - p.poisson * p.poisson));
    EXPECT_NEAR(p.bending_stiffness, D, 0.03 * D) << name;
  }
}

TEST(PresetFile, AGradeCarriesItsWeightInItsName) {
  for (const std::string& name : preset_names())
    EXPECT_NEAR(1e3 * read_preset(name).paper.area_density,
                std::stod(name.substr(name.find_first_of("0123456789"))), 1e-9)
        << name;
}

TEST(PresetFile, AGradeOfTheUsersOwnComesBeforeTheBuiltInOne) {
  const auto folder = std::filesystem::temp_directory_path() / "paperbake_preset_search";
  const std::filesystem::path own = folder / "config" / "paperbake" / "presets";
  std::filesystem::create_directories(own);
  std::string text = read_preset("copy70").text;
  text.replace(text.find("value = 0.070"), 13, "value = 0.071");
  const char* before = std::getenv("XDG_CONFIG_HOME");
  const std::string kept = before ? before : "";
  setenv("XDG_CONFIG_HOME", (folder / "config").c_str(), 1);
  const auto weight = [&] { return read_preset("copy70").paper.area_density; };
  EXPECT_EQ(weight(), 0.070);
  std::ofstream(own / "copy70.toml") << text;
  EXPECT_EQ(weight(), 0.071);
  EXPECT_EQ(user_preset_names(), std::vector<std::string>{"copy70"});
  before ? setenv("XDG_CONFIG_HOME", kept.c_str(), 1) : unsetenv("XDG_CONFIG_HOME");
  std::filesystem::remove_all(folder);
}

TEST(PresetFile, GrainMayBeLeftOutAndIsGivenInDegrees) {
  EXPECT_EQ(Paper{}.grain_ratio, 1);
  const PresetFile turned("[grain_angle]\nvalue = 0.0", "[grain_angle]\nvalue = 90.0");
  EXPECT_NEAR(read_preset(turned.path).paper.grain_angle, M_PI / 2, 1e-15);
  const std::string text = turned.text.substr(0, turned.text.find("[grain_ratio]"));
  std::ofstream(turned.path) << text;
  EXPECT_EQ(read_preset(turned.path).paper.grain_ratio, 1);
}

TEST(PresetFile, MayGiveTheFrictionOfThePaper) {
  const PresetFile rough("value = 0.45", "value = 0.6");
  EXPECT_EQ(read_preset(rough.path).paper.friction, 0.6);
  const std::string grade = read_preset("copy70").text;
  const PresetFile without(grade.substr(grade.find("[friction]")), "");
  EXPECT_EQ(read_preset(without.path).paper.friction, 0);
}

TEST(PresetFile, EntriesKeepTheOrderOfTheFileAndTheirEvidence) {
  const Preset preset = read_preset("copy90");
  ASSERT_EQ(preset.entries.size(), 11u);
  EXPECT_EQ(preset.entries[0].key, "thickness");
  EXPECT_EQ(preset.entries[0].unit, "m");
  EXPECT_EQ(preset.entries[0].mark, "read");
  EXPECT_NE(preset.entries[0].source.find("GPO O-63"), std::string::npos);
  EXPECT_EQ(preset.entries[5].key, "apex_scatter");
  EXPECT_EQ(preset.entries[5].mark, "assumed");
  EXPECT_EQ(preset.entries[7].key, "hardening");
}

TEST(PresetFile, AFileIsReadWithItsOwnValuesAndText) {
  const PresetFile file("value = 90e-6", "value = 95e-6");
  const Preset preset = read_preset(file.path);
  EXPECT_EQ(preset.paper.thickness, 95e-6);
  EXPECT_EQ(preset.paper.poisson, 0.3);
  EXPECT_EQ(preset.text, file.text);
}

TEST(PresetFile, AWholeNumberIsANumber) {
  const PresetFile file("value = 0.3", "value = 0");
  EXPECT_EQ(read_preset(file.path).paper.poisson, 0);
}

TEST(PresetFile, AnUnknownGradeIsAnErrorWithTheNearestNameAndTheList) {
  const Error error = error_of("copy7");
  EXPECT_EQ(error.cause, "Unknown paper \"copy7\". Did you mean \"copy70\"?");
  EXPECT_NE(error.remedy.find("copy70, copy80, copy90"), std::string::npos);
  EXPECT_EQ(error_of("cardboard").cause, "Unknown paper \"cardboard\".");
}

TEST(PresetFile, AnUnknownGradeOfASceneIsAnErrorOfTheSceneWhereItIsNamed) {
  for (const char* name : {"copi70", "missing/copy70.toml"}) try {
      read_preset(name, "shot.glb, sheet \"paper\"");
      FAIL() << name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code, ErrorCode::scene);
      EXPECT_EQ(error.place, "shot.glb, sheet \"paper\"");
      EXPECT_NE(error.cause.find(name), std::string::npos) << error.cause;
    }
}

TEST(PresetFile, AnUnknownTableIsNamedWhereItStands) {
  const PresetFile file("[thickness]", "[thicknes]");
  const Error error = error_of(file.path);
  EXPECT_EQ(error.place, file.place("[thicknes]"));
  EXPECT_EQ(error.cause, "Unknown key \"thicknes\". Did you mean \"thickness\"?");
}

TEST(PresetFile, AnUnknownKeyInATableIsNamedWhereItStands) {
  const PresetFile file("value = 2.7e-4", "valu = 2.7e-4");
  const Error error = error_of(file.path);
  EXPECT_EQ(error.place, file.place("valu = 2.7e-4"));
  EXPECT_EQ(error.cause, "Unknown key \"valu\". Did you mean \"value\"?");
}

TEST(PresetFile, OfTwoUnknownKeysTheFirstInTheFileIsNamed) {
  const PresetFile file("name = ", "zebra = 1\nant = 2\nname = ");
  EXPECT_EQ(error_of(file.path).place, file.path + ":1:1");
}

TEST(PresetFile, AMissingKeyIsNamedWithItsTable) {
  const PresetFile file("value = 0.070\n", "");
  const Error error = error_of(file.path);
  EXPECT_EQ(error.place, file.place("[area_density]"));
  EXPECT_EQ(error.cause, "The key \"value\" is missing from [area_density].");
}

TEST(PresetFile, AMissingTableIsNamed) {
  const PresetFile whole;
  const std::size_t at = whole.text.find("[hardening]");
  const PresetFile file(whole.text.substr(at), "");
  EXPECT_EQ(error_of(file.path).cause, "The key \"hardening\" is missing.");
}

TEST(PresetFile, AWrongTypeIsNamedAtTheValue) {
  const PresetFile file("value = 90e-6", "value = \"90e-6\"");
  const Error error = error_of(file.path);
  EXPECT_EQ(error.place, file.place("\"90e-6\""));
  EXPECT_EQ(error.cause, "The value of thickness must be a number.");
}

TEST(PresetFile, ABareNumberInPlaceOfATableIsRefused) {
  const PresetFile whole;
  const PresetFile file(whole.text, "name = \"mine\"\nthickness = 90e-6\n");
  const Error error = error_of(file.path);
  EXPECT_EQ(error.place, file.path + ":2:13");
  EXPECT_EQ(error.cause, "\"thickness\" must be a table with value, unit, source and mark.");
}

TEST(PresetFile, AWrongUnitIsNamedWithTheRightOne) {
  const PresetFile file("unit = \"kg/m2\"", "unit = \"g/m2\"");
  const Error error = error_of(file.path);
  EXPECT_EQ(error.place, file.place("\"g/m2\""));
  EXPECT_EQ(error.cause, "The unit of area_density is \"kg/m2\", not \"g/m2\".");
}

TEST(PresetFile, GramsForKilogramsAreOutOfRange) {
  const PresetFile file("value = 0.070", "value = 70.0");
  const Error error = error_of(file.path);
  EXPECT_EQ(error.place, file.place("70.0"));
  EXPECT_EQ(error.cause, "The area_density cannot be 70: paper lies between 0.001 and 10 [kg/m2].");
  EXPECT_EQ(error.remedy, "Give the value in kg/m2.");
}

TEST(PresetFile, ANumberWithoutAUnitIsOutOfRangeWithoutAUnit) {
  const PresetFile file("value = 0.3", "value = -0.1");
  const Error error = error_of(file.path);
  EXPECT_EQ(error.cause, "The poisson cannot be -0.1: paper lies between 0 and 0.49.");
  EXPECT_EQ(error.remedy, "Give a number within these bounds; it has no unit.");
}

TEST(PresetFile, NotANumberAndInfinityAreOutOfRange) {
  for (const char* value : {"value = nan", "value = inf", "value = -0.1"}) {
    const PresetFile file("value = 0.3", value);
    EXPECT_NE(error_of(file.path).cause.find("cannot be"), std::string::npos) << value;
  }
}

TEST(PresetFile, AnUnknownMarkIsAnErrorWithTheNearest) {
  const PresetFile file("mark = \"derived\"", "mark = \"derivd\"");
  EXPECT_EQ(error_of(file.path).cause, "Unknown mark \"derivd\". Did you mean \"derived\"?");
}

TEST(PresetFile, ASyntaxErrorHasLineAndColumn) {
  const PresetFile file("unit = \"N m\"", "unit = N m");
  const Error error = error_of(file.path);
  const std::string line = file.place("unit = N m");
  EXPECT_EQ(error.place.substr(0, error.place.rfind(':')), line.substr(0, line.rfind(':')));
  EXPECT_EQ(error.cause.rfind("This is not TOML: ", 0), 0u) << error.cause;
}

TEST(PresetFile, AnOpenQuoteIsSuspectedWhereALineOrTheFileEndsInAText) {
  for (const char* open : {"unit = \"N m", "unit = 'N m", "unit = \"\"\"N m", "unit = '''N m",
                           "unit = \"Nµ\\\"m", "unit = \"N m\r", "unit = '#' # 'unit'\nmark = \"a",
                           "unit = \"\"\"\"N m\"\"\"\"\nmark = 'a", "unit = [\"N\", \"m]"}) {
    const PresetFile file("unit = \"N m\"", open);
    EXPECT_EQ(error_of(file.path).remedy, "A quote before this place may not be closed.") << open;
  }
  for (const char* other :
       {"unit = \"N\\w\"", "unit = \"N\x01m\"", "unit =", "unit = [1,", "unit = = \"N m"}) {
    const PresetFile file("unit = \"N m\"", other);
    EXPECT_EQ(error_of(file.path).remedy, "") << other;
  }
}

TEST(PresetFile, AnEmptyFileMissesItsName) {
  const PresetFile whole;
  const PresetFile file(whole.text, "");
  EXPECT_EQ(error_of(file.path).cause, "The key \"name\" is missing.");
}

TEST(PresetFile, AFolderIsNotAPreset) {
  EXPECT_NE(
      error_of(std::filesystem::temp_directory_path().string()).cause.find("no such preset file"),
      std::string::npos);
}

}  // namespace
}  // namespace paperbake
