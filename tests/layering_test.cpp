// Checks the layers of the source tree, core <- formats <- baker, by its #include lines. Inside
// each layer the rooms (folders) lie on floors, and a room includes only rooms on lower floors. The
// three steps of the method know nothing of each other, and each of them has one public header.
// What a header declares is defined in its room.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

struct Source {
  std::string path;                   // from the root of the project
  std::vector<std::string> includes;  // the text between the quotes or angle brackets
  std::string code;                   // without comments
};

const std::vector<std::string> layers{"core", "formats", "baker"};  // from the bottom up

/// The rooms of all layers, floor by floor from the bottom up. Rooms on one floor do not include
/// each other.
const std::vector<std::vector<std::string>> floors{
    {"core/model"},
    {"core/linear_algebra"},
    {"core/geometry", "core/step3_developable"},
    {"core/step1_elastic", "core/step2_crumple", "core/render"},
    {"core/hands", "core/methods"},
    {"core/animation"},
    {"formats/files"},
    {"formats/config"},
    {"formats/cache", "formats/maps", "formats/scene"},
    {"baker/job"},
    {"baker/output"},
    {"baker/check"},
    {"baker/bake"},
    {"baker/studies"},
    {"baker/command_line"},
};

/// The room of a file, such as "core/render"; empty for a file in no room, such as baker/main.cpp.
std::string room_of(const std::string& path) {
  const std::size_t first = path.find('/'), second = path.find('/', first + 1);
  return second == std::string::npos ? "" : path.substr(0, second);
}

/// Number of the floor of a room, from the bottom up; -1: it has none.
int floor_of(const std::string& room) {
  for (std::size_t i = 0; i < floors.size(); ++i)
    if (std::count(floors[i].begin(), floors[i].end(), room)) return static_cast<int>(i);
  return -1;
}

int layer_of(const std::string& path) {
  for (std::size_t i = 0; i < layers.size(); ++i)
    if (path.rfind(layers[i] + "/", 0) == 0) return static_cast<int>(i);
  return -1;
}

/// The step that a file belongs to, such as "core/step1_elastic"; empty outside the steps.
std::string step_of(const std::string& path) {
  std::smatch found;
  return std::regex_search(path, found, std::regex("^core/step[0-9]_[^/]+(?=/)")) ? found.str()
                                                                                  : "";
}

/// Removes the comments, which may mention what the code must not do.
std::string without_comments(std::string text) {
  for (std::size_t begin = 0; (begin = text.find('/', begin)) != std::string::npos;) {
    std::size_t end = begin;
    if (text.compare(begin, 2, "//") == 0) end = text.find('\n', begin);
    if (text.compare(begin, 2, "/*") == 0) end = text.find("*/", begin + 2) + 2;
    if (end == begin)
      ++begin;
    else
      text.erase(begin, end - begin);
  }
  return text;
}

Source read_source(const fs::path& path) {
  std::ifstream file(path);
  Source source{fs::relative(path, PAPERBAKE_SOURCE).generic_string(),
                {},
                without_comments({std::istreambuf_iterator<char>(file), {}})};
  const std::regex line(R"(#[ \t]*include[ \t]*[<"]([^>"]+)[>"])");
  for (std::sregex_iterator it(source.code.begin(), source.code.end(), line), end; it != end; ++it)
    source.includes.push_back((*it)[1]);
  return source;
}

std::vector<Source> sources_of(const std::string& layer) {
  std::vector<Source> sources;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(PAPERBAKE_SOURCE) / layer))
    if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h")
      sources.push_back(read_source(entry.path()));
  return sources;
}

std::vector<Source> all_sources() {
  std::vector<Source> all;
  for (const std::string& layer : layers)
    for (Source& source : sources_of(layer)) all.push_back(std::move(source));
  return all;
}

bool is_header(const Source& source) { return fs::path(source.path).extension() == ".h"; }

/// Names of the functions outside of classes that a header declares and does not define. They begin
/// at the left margin, as clang-format sets them.
std::set<std::string> functions_declared_in(const Source& header) {
  static const std::regex arguments("<[^<>;{}]*>"),
      declaration(R"(\n(?!(struct|class|enum|using|template|namespace|extern|constexpr|inline)\b))"
                  R"([A-Za-z:][^;{}()]*\b(\w+)\([^;{}]*\)( noexcept)?;)");
  std::string code = header.code, before;
  while (code != before) code = std::regex_replace(before = code, arguments, "");
  std::set<std::string> names;
  for (std::sregex_iterator it(code.begin(), code.end(), declaration), end; it != end; ++it)
    names.insert((*it)[2]);
  return names;
}

/// Names of the functions outside of classes that a .cpp defines, and perhaps some others.
std::set<std::string> functions_defined_in(const Source& source) {
  static const std::regex name(R"((^|[^\w:])(\w+)\()");
  std::set<std::string> names;
  std::istringstream lines(source.code);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || !std::isalpha(static_cast<unsigned char>(line[0]))) continue;
    for (std::sregex_iterator it(line.begin(), line.end(), name), end; it != end; ++it)
      names.insert((*it)[2]);
  }
  return names;
}

class LayeringTest : public testing::Test {
 protected:
  /// These tests must not pass because a folder was moved or not found.
  void SetUp() override {
    for (const std::string& layer : layers)
      ASSERT_GT(sources_of(layer).size(), 5u)
          << "no sources in " << layer << "/ of " << PAPERBAKE_SOURCE;
    std::size_t own = 0;
    for (const Source& source : all_sources())
      for (const std::string& include : source.includes) own += layer_of(include) >= 0;
    ASSERT_GT(own, 50u) << "hardly an #include of a file of ours was found";
  }
};

TEST_F(LayeringTest, CoreKnowsNothingOfFormatsAndFormatsNothingOfTheBaker) {
  for (const Source& source : all_sources())
    for (const std::string& include : source.includes)
      EXPECT_LE(layer_of(include), layer_of(source.path)) << source.path << " includes " << include;
}

TEST_F(LayeringTest, AnIncludeGoesToALowerFloor) {
  for (const Source& source : all_sources()) {
    const std::string here = room_of(source.path);
    if (here.empty()) continue;
    EXPECT_GE(floor_of(here), 0) << here << " has no floor";
    for (const std::string& include : source.includes) {
      if (layer_of(include) < 0 || room_of(include) == here) continue;
      EXPECT_LT(floor_of(room_of(include)), floor_of(here))
          << source.path << " includes " << include;
    }
  }
}

TEST_F(LayeringTest, AHeaderIsImplementedInItsOwnRoom) {
  std::map<std::string, std::set<std::string>> defined;  // by header
  for (const Source& source : all_sources()) {
    if (is_header(source)) continue;
    const std::string room = room_of(source.path), stem = fs::path(source.path).stem();
    const std::set<std::string> names = functions_defined_in(source);
    for (const std::string& include : source.includes) {
      if (layer_of(include) < 0) continue;
      EXPECT_TRUE(fs::path(include).stem() != stem || room_of(include) == room)
          << source.path << " is in another room than " << include;
      if (room_of(include) == room) defined[include].insert(names.begin(), names.end());
    }
  }
  int declared = 0;
  for (const Source& source : all_sources()) {
    if (!is_header(source)) continue;
    for (const std::string& name : functions_declared_in(source)) {
      ++declared;
      EXPECT_TRUE(defined[source.path].count(name))
          << "no .cpp of " << room_of(source.path) << " that includes " << source.path
          << " defines " << name;
    }
  }
  EXPECT_GT(declared, 300) << "hardly a function that a header declares was found";
}

TEST_F(LayeringTest, EveryRoomThatHasAFloorExists) {
  for (const auto& floor : floors)
    for (const std::string& room : floor)
      EXPECT_TRUE(fs::is_directory(fs::path(PAPERBAKE_SOURCE) / room)) << room;
}

TEST_F(LayeringTest, ProjectFilesAreIncludedByTheirPathFromTheRoot) {
  for (const Source& source : all_sources())
    for (const std::string& include : source.includes) {
      const bool from_root = layer_of(include) >= 0,
                 beside =
                     fs::exists((fs::path(PAPERBAKE_SOURCE) / source.path).parent_path() / include);
      EXPECT_TRUE(!from_root || fs::exists(fs::path(PAPERBAKE_SOURCE) / include))
          << source.path << " includes " << include;
      EXPECT_FALSE(beside) << source.path << " includes " << include;
    }
}

TEST_F(LayeringTest, TheStepsNeverIncludeEachOther) {
  int steps = 0;
  for (const Source& source : sources_of("core")) {
    if (step_of(source.path).empty()) continue;
    ++steps;
    for (const std::string& include : source.includes)
      EXPECT_TRUE(step_of(include).empty() || step_of(include) == step_of(source.path))
          << source.path << " includes " << include;
  }
  EXPECT_GT(steps, 2);
}

TEST_F(LayeringTest, AStepIsIncludedThroughTheHeaderOfItsNameOnly) {
  int doors = 0;
  for (const Source& source : all_sources())
    for (const std::string& include : source.includes) {
      const std::string step = step_of(include);
      if (step.empty() || step == step_of(source.path)) continue;
      ++doors;
      // for example core/step1_elastic/elastic.h
      const std::string door = step + step.substr(step.rfind('_')).replace(0, 1, "/") + ".h";
      EXPECT_EQ(include, door) << source.path;
    }
  EXPECT_GT(doors, 0);
}

TEST_F(LayeringTest, CoreReadsNoFilesAndPrintsNothing) {
  const std::regex header(
      "iostream|fstream|filesystem|fmt/.*|nlohmann/.*|toml.*|CLI/.*|assimp/.*|Imf.*");
  const std::regex call(
      R"(\bv?f?printf\s*\(|\bfmt::print\b|\bstd::c(out|err|log)\b|\bputs\s*\(|\bfopen\s*\(|\bexit\s*\()");
  for (const Source& source : sources_of("core")) {
    for (const std::string& include : source.includes)
      EXPECT_FALSE(std::regex_match(include, header)) << source.path << " includes " << include;
    std::smatch found;
    EXPECT_FALSE(std::regex_search(source.code, found, call)) << source.path << ": " << found.str();
  }
}

/// All methods are timed at the same place: in the loops that make the frames.
TEST_F(LayeringTest, CoreHasOneClockAndOnlyTheLoopsOverFramesReadIt) {
  const std::regex clock(
      R"(<(chrono|ctime|time\.h|sys/time\.h|sys/resource\.h)>|\bclock(_gettime)?\s*\(|)"
      R"(\btime\s*\(\s*(NULL|nullptr|0)\s*\)|\bgettimeofday\b|\bgetrusage\b|_clock::now\b)");
  bool known = false;
  std::vector<std::string> who;
  for (const Source& source : sources_of("core")) {
    std::smatch found;
    const bool has = std::regex_search(source.code, found, clock);
    if (source.path == "core/animation/cpu_clock.h")
      known = has;
    else
      EXPECT_FALSE(has) << source.path << ": " << found.str();
    for (const std::string& include : source.includes)
      if (include == "core/animation/cpu_clock.h") who.push_back(source.path);
  }
  EXPECT_TRUE(known)
      << "the timers are gone, or this test no longer knows a clock when it sees one";
  std::sort(who.begin(), who.end());
  EXPECT_EQ(who, (std::vector<std::string>{"core/animation/animate.cpp",
                                           "core/animation/polished_animation.cpp"}));
}

TEST_F(LayeringTest, OnlyOneRoomParsesTheCommandLine) {
  std::set<std::string> rooms;
  for (const Source& source : all_sources())
    for (const std::string& include : source.includes)
      if (include.rfind("CLI/", 0) == 0) rooms.insert(room_of(source.path));
  EXPECT_EQ(rooms, std::set<std::string>{"baker/command_line"});
}

}  // namespace
}  // namespace paperbake
