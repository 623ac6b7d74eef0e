#include "formats/config/nearest_word.h"

#include <gtest/gtest.h>

namespace paperbake {
namespace {

TEST(NearestWord, AcceptsSlipsAndNothingElse) {
  const std::vector<std::string> words = {"thickness", "poisson", "unit"};
  EXPECT_EQ(nearest_word("thicknes", words), "thickness");
  EXPECT_EQ(nearest_word("thinkess", words), "thickness");
  EXPECT_EQ(nearest_word("posison", words), "poisson");  // a swap counts as one error
  EXPECT_EQ(nearest_word("unti", words), "unit");
  EXPECT_EQ(nearest_word("density", words), "");
  EXPECT_EQ(nearest_word("", words), "");
  EXPECT_EQ(nearest_word("a", {"b"}), "");
}

TEST(NearestWord, IsASentenceWhereThereIsOne) {
  EXPECT_EQ(did_you_mean("copy7", {"copy70", "book90"}), " Did you mean \"copy70\"?");
  EXPECT_EQ(did_you_mean("newsprint", {"copy70"}), "");
}

}  // namespace
}  // namespace paperbake
