#pragma once

#include "baker/job/settings.h"
#include "core/methods/method.h"
#include "core/model/shot.h"

#include <cstddef>
#include <string>

namespace paperbake {

inline constexpr const char* all_methods = "hybrid, fem, adaptive, hybrid+fem";
inline constexpr const char* hybrid_and_fem = "hybrid+fem";  // hybrid, polished

/// Is this a method that --method accepts?
bool is_method(const std::string&);

/// Does the hybrid simulate the sheets, whether its frames are polished or not?
bool is_hybrid(const BakeSettings&);

/// Whether the first mesh may have more triangles than the settings say: no number was asked for.
bool may_be_finer(const BakeSettings&);

/// Number of triangles of the mesh; of the hybrid: the largest number that its mesh may have.
int triangles_wanted(const BakeSettings&);

/// Number of triangles with which the hybrid begins: no more than it may have.
/// throws  Error(ErrorCode::command) when --base-triangles asks for more
int base_wanted(const BakeSettings&);

/// Number of triangles of the first mesh of a sheet, where neither handles nor a rehearsal ask for
/// more. If no number was asked for, a strip gets more than others, so that two rows stand across
/// it, and as many times more as the settings have more than their default.
int first_triangles(const BakeSettings&, const Pattern&);

/// The method that simulates one sheet of a bake.
/// sheet  its number in the scene, from 0: sheets of the same seed differ in what is random
MethodChoice make_method(const BakeSettings&, const Shot&, unsigned seed, std::size_t sheet);

// [triangles] with fewer a mesh has no room for handles and folds
inline constexpr int min_polish_triangles = 100;

/// Whether every frame is refined on a fine finite element mesh
/// (core/animation/polished_animation.h).
struct Polishing {
  int triangles = 0;  // 0: it is not
  std::string why;
};

/// What the settings say of polish; whether the sheets have inertia, which rules it out, is not
/// looked at.
/// throws  Error(ErrorCode::command) when polish is asked for but has no effect
Polishing decided_polishing(const BakeSettings&);

}  // namespace paperbake
