#pragma once

#include <set>
#include <string>
#include <utility>

namespace paperbake {

/// Keeps the names in one place of a file apart: "a.b" and "a_b" may become the same name where a
/// format does not allow all characters.
class OwnNames {
 public:
  /// taken  names that the file has besides
  explicit OwnNames(std::set<std::string> taken = {}) : taken_(std::move(taken)) {}

  /// legal    a name as the format allows it
  /// returns  the same, or the first of NAME_2, NAME_3, ... that nobody has
  std::string operator()(const std::string& legal) {
    std::string own = legal;
    for (int n = 2; !taken_.insert(own).second; ++n) own = legal + "_" + std::to_string(n);
    return own;
  }

 private:
  std::set<std::string> taken_;
};

/// What the sheets of all caches have, besides what the artist has made.
inline std::set<std::string> names_of_caches() { return {"crease", "pattern", "velocity"}; }

}  // namespace paperbake
