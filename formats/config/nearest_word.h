#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace paperbake {

/// How many letters of one word have to be inserted, deleted, replaced or swapped with their
/// neighbour to make it the other: the optimal string alignment distance.
std::size_t edit_distance(const std::string& word, const std::string& other);

/// The word most similar to `word` by edit distance, the first of equals. Empty when none is
/// similar enough to be meant: at most a third of the letters of the longer word may differ, and
/// one always may.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);

/// ' Did you mean "copy70"?', or an empty text when no word is similar enough.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& words);

}  // namespace paperbake
