#include "formats/config/nearest_word.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {

std::size_t edit_distance(const std::string& word, const std::string& other) {
  const std::size_t n = word.size(), m = other.size();
  std::vector<std::vector<std::size_t>> d(n + 1, std::vector<std::size_t>(m + 1));
  for (std::size_t i = 0; i <= n; ++i)
    for (std::size_t j = 0; j <= m; ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      d[i][j] = std::min(
          {d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (word[i - 1] != other[j - 1])});
      if (i > 1 && j > 1 && word[i - 1] == other[j - 2] && word[i - 2] == other[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[n][m];
}

std::string nearest_word(const std::string& word, const std::vector<std::string>& words) {
  std::string nearest;
  std::size_t least = std::string::npos;
  for (const std::string& other : words) {
    const std::size_t longer = std::max(word.size(), other.size()),
                      count = edit_distance(word, other);
    const std::size_t allowed = std::max<std::size_t>(1, longer / 3);
    if (count > allowed || count >= longer || count >= least) continue;
    nearest = other;
    least = count;
  }
  return nearest;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& words) {
  const std::string nearest = nearest_word(word, words);
  return nearest.empty() ? "" : fmt::format(" Did you mean \"{}\"?", nearest);
}

}  // namespace paperbake
