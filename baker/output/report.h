#pragma once

#include "baker/job/plan.h"
#include "baker/output/frame_writer.h"
#include "core/geometry/hinges.h"
#include "formats/cache/alembic_cache.h"
#include "formats/files/certificate.h"

#include <string>
#include <utility>
#include <vector>

namespace paperbake {

/// report.html: one page that opens from disk in any browser, with everything in it. The animation
/// in 3D to play, scrub and orbit, with handles and colliders, curves over time, the maps at the
/// end, the settings. It opens at
/// the frame in which the paper is folded most: the largest sum, over the inner edges of the
/// meshes, of length times dihedral angle. Positions are kept in 16 bits (1/65,535 of the room the
/// sheet takes); a shot of so many vertices that the page would be larger than about 12 MB is shown
/// in fewer frames.
class Report {
 public:
  /// frames  that will be added of each sheet
  Report(const BakePlan&, std::size_t frames);

  /// The next frame of a sheet as it is in the cache.
  void add_frame(std::size_t sheet, const CacheFrame&);

  /// A picture for the page. png: the bytes of a file
  void add_map(const std::string& caption, const std::string& png);

  /// The handles of all frames.
  void set_handles(std::vector<HandleRecord> handles) { handles_ = std::move(handles); }

  std::string html(const BakeEnding&) const;

 private:
  using Floats3 = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  struct ShownFrame {
    std::size_t mesh;
    Floats3 x;
    double folding;  // [m rad] length times dihedral angle, over all inner edges
  };
  struct ShownSheet {
    std::vector<Triangles> meshes;
    Hinges hinges;  // of the last of them
    std::vector<ShownFrame> frames;
    std::size_t given = 0;
  };
  struct Picture {
    std::string caption, png;
  };

  /// Number, among the frames of the bake, of the one in which all sheets together are folded most;
  /// the first of equals.
  std::size_t most_folded() const;

  const BakePlan& plan_;
  std::size_t frames_, stride_ = 1;
  std::vector<ShownSheet> sheets_;
  std::vector<Picture> maps_;
  std::vector<HandleRecord> handles_;
};

}  // namespace paperbake
