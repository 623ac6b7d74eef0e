#pragma once

#include <string>
#include <vector>

namespace paperbake::test {

/// The keys of a line of cert/frames.jsonl, in the order that docs/output_files.md gives them.
inline const std::vector<std::string> frame_keys{"frame",
                                                 "sheet",
                                                 "triangles",
                                                 "stretch_mean_pct",
                                                 "stretch_max_pct",
                                                 "angle_defect_max_deg",
                                                 "handle_err_max_mm",
                                                 "singular",
                                                 "new_singular",
                                                 "folds",
                                                 "elastic_ms",
                                                 "geometry_ms",
                                                 "moved_mm",
                                                 "driven_mm",
                                                 "inertia",
                                                 "substeps",
                                                 "newton_iterations",
                                                 "converged",
                                                 "energy_J",
                                                 "render_triangles",
                                                 "render_stretch_mean_pct",
                                                 "render_stretch_max_pct",
                                                 "render_ms",
                                                 "render_crossings",
                                                 "render_crossings_with_others",
                                                 "crossings",
                                                 "crossings_with_others",
                                                 "touching",
                                                 "touching_others",
                                                 "on_colliders",
                                                 "inside_mm",
                                                 "render_stretch_at_mm",
                                                 "inside_at_mm",
                                                 "inside_of",
                                                 "jammed",
                                                 "note",
                                                 "input_hash",
                                                 "content_hash"};

}  // namespace paperbake::test
