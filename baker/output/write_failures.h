#pragma once

#include "core/model/error.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// A file that could not be written, or not to its end.
struct Loss {
  std::string file;
  Error error;
  // what there is of it all the same, as a sentence goes on: "ends at frame 4"
  std::string kept = {};
};

/// What a bake could not write. One writer that fails takes nothing from the others: what was
/// simulated goes on to all that still work, and the bake ends with the first of these errors.
class Losses {
 public:
  /// Calls write(), unless it failed before for this file. What it throws becomes a loss. returns
  /// whether it was written
  bool attempt(const std::string& file, const std::function<void()>& write);

  /// How much of a file that was lost there is after all; a loss for `error` when it was not one
  /// yet.
  void kept(const std::string& file, const std::string& how_much, const Error& error);

  const std::vector<Loss>& all() const { return all_; }

  /// "there is no maps/S4.0013.exr; S4.abc ends at frame 4", the first few of them.
  std::string sentence() const;

 private:
  Loss* find(const std::string& file);
  std::vector<Loss> all_;
};

}  // namespace paperbake
