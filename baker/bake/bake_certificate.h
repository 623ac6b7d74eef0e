#pragma once

#include "baker/job/plan.h"
#include "baker/output/sheet_intersections.h"
#include "formats/files/certificate.h"

#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace paperbake {

/// The certificate of a bake while its frames come in: the rows of frames.jsonl, handles.csv and
/// singular.csv of all sheets.
class BakeCertificate {
 public:
  explicit BakeCertificate(const BakePlan&);

  /// Adds the line of a frame of a sheet. The reference is valid until the next one is added.
  FrameRecord& add_line(std::size_t sheet, FrameRecord);
  /// The line that was added for this frame of this sheet.
  FrameRecord& line(std::size_t sheet, int frame);

  /// Counts where the sheets of a scene pass through each other; they are added in their order.
  SheetIntersections intersections;
  std::vector<HandleRecord> handles;
  std::vector<SingularRecord> singular;
  double crease_length = 0;  // [m] of the last frames of all sheets
  // of each sheet: the lines along which it was folded although nothing announced them; their
  // numbers follow those of PlannedSheet::crease_lines
  std::vector<std::vector<CreaseLine>> found_creases;
  // of each sheet and each of its crease lines: the first frame in which it is folded
  std::vector<std::vector<std::optional<int>>> frames_of_folding;

  /// Lines so far; after finalize frame by frame.
  const std::vector<FrameRecord>& frames() const { return frames_; }
  /// How many lines each sheet has.
  std::vector<std::size_t> lines_of_sheets() const;

  /// Sorts lines and handles by frame, singular points by sheet, and removes content hashes of
  /// frames that are not in the cache. No line can be added or found afterwards.
  /// in_cache  frames of each sheet that the cache has: the first ones
  void finalize(const std::vector<std::size_t>& in_cache);

 private:
  const BakePlan& plan_;
  std::vector<FrameRecord> frames_;
  std::map<std::pair<std::size_t, int>, std::size_t> line_of_;  // sheet and frame -> line
};

}  // namespace paperbake
