#pragma once

#include "formats/scene/scene_file.h"

#include <string>
#include <vector>

namespace paperbake {

/// Creases of a job file with the points that nearly lie on the border moved onto it: the sheet may
/// be 0.1000001 m wide where the job says 0.1.
std::vector<PrescribedCrease> with_ends_on_border(std::vector<PrescribedCrease>, const Pattern&);

/// Checks that singular points and creases of a job file lie on the sheet.
/// place   of the job file, for the message
/// name    of the sheet
/// throws  Error(ErrorCode::command)
void check_rules(const SingularPointRules&, const Pattern&, const std::string& place,
                 const std::string& name);

/// Leads the creases of a sheet through the handles and fixed singular points that they would pass
/// at less than 0.2 % of the longer side: a mesh with both would have slivers between them.
void snap_creases_to_points(SceneSheet&);

/// "0.21 x 0.297 m"
std::string metres(const Vector2d& size);

}  // namespace paperbake
