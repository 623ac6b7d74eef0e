// Passes the corpus of the fuzzers, which holds their findings and the files they started from,
// through the readers by the same calls.

#include "tests/fuzz/readers.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

class CorpusTest : public testing::TestWithParam<std::string> {};

/// The corpus folders of a reader. Scenes are also read by the readers of their animation curves.
std::vector<fs::path> folders_of(const std::string& reader) {
  std::vector<fs::path> folders{fs::path(PAPERBAKE_CORPUS) / reader};
  if (reader == "gltf_curves" || reader == "fbx")
    folders.push_back(fs::path(PAPERBAKE_CORPUS) / "scene");
  return folders;
}

TEST_P(CorpusTest, EveryFileIsReadOrRejectedWithPlaceAndCause) {
  const fuzz::Reader& read = fuzz::readers().at(GetParam());
  int files = 0;
  for (const fs::path& folder : folders_of(GetParam())) {
    if (!fs::exists(folder)) continue;  // the fuzzers have found nothing yet
    for (const auto& entry : fs::directory_iterator(folder)) {
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string bytes{std::istreambuf_iterator<char>(file), {}};
      EXPECT_NO_THROW(read(bytes)) << entry.path();
      ++files;
    }
  }
  EXPECT_GT(files, 0);
}

INSTANTIATE_TEST_SUITE_P(Readers, CorpusTest,
                         testing::Values("scene", "imported", "gltf_curves", "fbx", "preset",
                                         "lock", "job", "certificate", "cache", "state",
                                         "checkpoint"),
                         [](const auto& reader) { return reader.param; });

}  // namespace
}  // namespace paperbake
