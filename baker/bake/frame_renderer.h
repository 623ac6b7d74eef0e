#pragma once

#include "baker/bake/render_input.h"
#include "baker/bake/render_shapes.h"
#include "baker/output/cache_judge.h"
#include "core/model/frame_statistics.h"
#include "core/render/render_surface.h"
#include "core/render/untangle_sheets.h"

#include <cstddef>
#include <deque>
#include <future>
#include <optional>
#include <vector>

namespace paperbake {

/// One frame of every sheet that has it, the first ones: a bake may have ended between two sheets.
struct FrameOfSheets {
  std::vector<RenderFrame> frames;
  struct Verdict {
    RenderStatistics statistics;
    Judgement judgement;
    double handle_error = 0;  // [m]
  };
  std::vector<Verdict> verdicts;  // of a frame that is wanted
};

/// Renders frames of the records, some of them ahead of the one that is asked for, each on a thread
/// of its own.
class FrameRenderer {
 public:
  FrameRenderer(const std::vector<RenderInput>&, std::vector<RenderSurface>&, const RenderOptions&);

  /// The k-th frame of the records; k grows from call to call.
  FrameOfSheets operator()(std::size_t k);

 private:
  struct PendingFrame {
    std::size_t k;
    std::shared_future<FrameOfSheets> rendered;
    bool repeated = false;  // it is the frame before, which rests
  };

  /// The k-th frame is the one before to the last bit, in all that its rendering depends on.
  bool rests(std::size_t k) const;
  /// The frame is wanted, or one beside it, whose velocity depends on it.
  bool is_needed(std::size_t k) const;
  /// False while frames are pending in which other handles hold the sheet.
  bool start(std::size_t k);
  FrameOfSheets render(std::size_t k, const std::vector<ShapeCache::Sum>& shapes) const;
  /// Pushes the sheets of a frame out of colliders, so far that they lie on them: the surface is
  /// the middle of the paper. Where that would put one through itself or another, only as far as
  /// nothing is inside.
  /// ms  of each sheet; what it takes is added
  void clear_colliders(std::size_t k, const std::vector<SheetUntangler::Simulated>& simulated,
                       std::vector<RenderFrame>& frames, std::vector<double>& ms) const;
  void count_crossings(std::size_t s, RenderFrame&) const;
  int crossings_between_sheets(const std::vector<RenderFrame>&) const;
  /// ms  of each sheet
  std::vector<FrameOfSheets::Verdict> judge(std::size_t k, const std::vector<RenderFrame>& frames,
                                            const std::vector<double>& ms) const;
  double handle_error(std::size_t s, const RecordedFrame& recorded, const Points3& x) const;

  const std::vector<RenderInput>& inputs_;
  std::vector<RenderSurface>& surfaces_;
  const SheetUntangler untangler_;
  std::vector<CacheJudge> judges_;
  std::vector<std::vector<int>> vertex_of_handle_;  // of each sheet, on its render mesh
  const FrameSpan& wanted_;
  const std::size_t threads_;
  StageClock* const clock_;
  std::vector<std::optional<std::vector<int>>> held_;
  std::vector<ShapeCache> shapes_;
  std::size_t next_ = 0;              // the first that was not started
  std::deque<PendingFrame> pending_;  // in order
  std::optional<PendingFrame> last_;  // that was started
};

}  // namespace paperbake
