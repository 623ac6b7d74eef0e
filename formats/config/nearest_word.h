#pragma once

#include <string>
#include <vector>

namespace paperbake {

/// The word most similar to `word` by edit distance (insert, delete, replace, swap neighbours),
/// the first of equals. Empty when none is similar enough to be meant: at most a third of the
/// letters of the longer word may differ, and one always may.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);

/// ' Did you mean "copy70"?', or an empty text when no word is similar enough.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& words);

}  // namespace paperbake
