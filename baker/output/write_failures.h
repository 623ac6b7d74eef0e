#pragma once

#include "core/model/error.h"

#include <functional>
#include <string>
#include <vector>

namespace paperbake {

/// A file that could not be written, or not to its end.
struct WriteFailure {
  std::string file;
  Error error;
  // what there is of it all the same, as a sentence goes on: "ends at frame 4"
  std::string partial = {};
};

/// What a bake could not write. One writer that fails takes nothing from the others: what was
/// simulated goes on to all that still work, and the bake ends with the first of these errors.
class WriteFailures {
 public:
  /// Calls write(), unless it failed before for this file. What it throws is recorded as the
  /// failure of this file. returns whether it was written
  bool try_write(const std::string& file, const std::function<void()>& write);

  /// Says how much of a failed file there is all the same. Records `error` as its failure if none
  /// was recorded.
  void record_partial(const std::string& file, const std::string& how_much, const Error& error);

  const std::vector<WriteFailure>& all() const { return all_; }

  /// "there is no maps/S4.0013.exr; S4.abc ends at frame 4", the first few of them.
  std::string summary() const;

 private:
  WriteFailure* find(const std::string& file);
  std::vector<WriteFailure> all_;
};

}  // namespace paperbake
