#pragma once

#include "baker/job/settings.h"
#include "core/geometry/collider_motion.h"
#include "formats/cache/alembic_cache.h"
#include "formats/files/certificate.h"
#include "formats/files/raster_image.h"

#include <memory>
#include <string>
#include <vector>

namespace paperbake {

/// A collider where it is at one moment.
struct PlacedCollider {
  Points3 x;  // |V|x3 [m]
  Triangles triangles;
};

/// One picture of a contact sheet: what sheets and handles are like at one moment.
struct Panel {
  std::vector<std::string> caption;   // lines
  std::vector<CacheFrame> sheets;     // x, triangles, normal and normal_of_corner are shown
  std::vector<HandleRecord> handles;  // those that hold or are jammed
  std::vector<PlacedCollider> colliders = {};
};

/// Panels side by side, 1,300 px wide, seen by one camera that stands still: from the front left
/// above, far enough for all of them. Paper is lit from the left, its back a little bluer than its
/// front; hollows are darker. Handles are dots, green where they hold and orange where they are
/// jammed; what the paper hides of them is smaller. Colliders are dark blue-grey as far as they are
/// in the picture of the paper; where they stand before it they are a veil.
Image contact_sheet(const std::string& title, const std::vector<Panel>&);

/// Of the frames of a bake those that its preview shows: every n-th and the last, at most 16.
FrameSpan preview_frames(const FrameSpan&);

/// NAME.preview.png: the frames of a bake as they come.
class Preview {
 public:
  /// colliders: null where there are none; first_frame: theirs
  Preview(std::string title, const FrameSpan& frames, std::shared_ptr<const Colliders> colliders,
          int first_frame)
      : title_(std::move(title)),
        frames_(preview_frames(frames)),
        colliders_(std::move(colliders)),
        first_frame_(first_frame) {}

  /// A frame of one of the sheets; kept when it is one that is shown.
  void add_frame(int frame, const CacheFrame&);

  /// The handles of all frames; those of frames that are shown are kept.
  void add_handles(const std::vector<HandleRecord>&);

  /// verdict  is added to the title
  Image picture(const std::string& verdict) const;

 private:
  struct PreviewFrame {
    int frame;
    std::vector<CacheFrame> sheets;
    std::vector<HandleRecord> handles;  // that hold or are jammed
  };
  std::string title_;
  FrameSpan frames_;
  std::shared_ptr<const Colliders> colliders_;
  int first_frame_;
  std::vector<PreviewFrame> shown_;  // in order
};

}  // namespace paperbake
