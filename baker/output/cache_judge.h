#pragma once

#include "core/geometry/intersections.h"
#include "core/geometry/judged_colliders.h"
#include "core/geometry/measure.h"
#include "formats/cache/alembic_cache.h"
#include "formats/files/certificate.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace paperbake {

/// What a frame is worth, whoever made it.
struct Judgement {
  LengthDistortion length;
  int crossings = 0;
  double inside = 0;         // [m] how deep its deepest point is inside a collider
  Vector2d inside_at{0, 0};  // [m] that point on the pattern
  std::string inside_of;     // the name of that collider
};

/// Judges frames on one mesh, from what a file has of them and nothing else: `bake` asks it about
/// the frames that it hands on, and `verify` about those that it finds. It shares no code with the
/// solver, and with the render mesh only the CrossingCounter.
class CacheJudge {
 public:
  /// uv           |V|x2 in shares of the longer side
  /// longer_side  [m] of the pattern
  /// colliders    null: there are none
  CacheJudge(const Points2& uv, const Triangles&, double longer_side,
             std::shared_ptr<const JudgedColliders> colliders);

  /// x        |V|x3 [m]; rounded to 32 bits here, as the file has it
  /// row      frame - first frame of the scene
  /// counted  the crossings of the rounded x, where a CrossingCounter has counted them before
  Judgement operator()(const Points3& x, int row, std::optional<int> counted = {}) const;

  /// The vertex that is nearest to a point of the pattern. [m]
  int vertex_at(const Vector2d&) const;
  const Triangles& triangles() const { return triangles_; }
  /// Does a frame have this mesh?
  bool is_of(const CacheFrame&) const;

 private:
  LengthDistortion distortion(const Points3& x) const;

  Points2 uv_;
  Points2 pattern_;  // [m]
  Triangles triangles_;
  struct Edge {
    int a, b;
    double rest;  // [m]
  };
  std::vector<Edge> edges_;  // each once
  CrossingCounter crossings_;
  std::shared_ptr<const JudgedColliders> colliders_;
};

/// Positions as a cache has them: rounded to 32 bits. [m]
Points3 as_stored(const Points3& x);

RenderStatistics statistics_of(const Judgement&, const CacheJudge&);

/// Enters the verdict on a frame into its line of the certificate, with a note where the sheet is
/// visibly inside a collider.
void enter(const Judgement&, FrameRecord&);

}  // namespace paperbake
