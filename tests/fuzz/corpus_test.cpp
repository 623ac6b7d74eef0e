// Readers under fire: what the fuzzers have found, and files to begin with, through the same calls.

#include "tests/fuzz/readers.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace paperbake {
namespace {

namespace fs = std::filesystem;

class Corpus : public testing::TestWithParam<std::string> {};

TEST_P(Corpus, EveryFileEndsInAReturnOrInAnErrorWithPlaceAndCause) {
  const fuzz::Reader& read = fuzz::readers().at(GetParam());
  int files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(PAPERBAKE_CORPUS) / GetParam())) {
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    EXPECT_NO_THROW(read(bytes)) << entry.path();
    ++files;
  }
  EXPECT_GT(files, 0);
}

INSTANTIATE_TEST_SUITE_P(Readers, Corpus, testing::Values("scene", "imported", "preset", "lock", "job", "certificate", "cache"),
                         [](const auto& reader) { return reader.param; });

}  // namespace
}  // namespace paperbake
