#include "baker/job/method_choice.h"

#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "core/model/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {

bool is_method(const std::string& name) {
  return name == "hybrid" || name == "fem" || name == "adaptive" || name == hybrid_and_fem;
}

bool is_hybrid(const BakeSettings& settings) {
  return settings.method == "hybrid" || settings.method == hybrid_and_fem;
}

bool may_be_finer(const BakeSettings& settings) {
  return !settings.triangles && !settings.accuracy && !settings.budget &&
         settings.given.count("base_triangles") == 0;
}

int triangles_wanted(const BakeSettings& settings) {
  return settings.triangles.value_or(is_hybrid(settings)
                                         ? std::max(1000, 2 * settings.base_triangles)
                                     : settings.method == "adaptive" ? 3000
                                                                     : 1700);
}

int base_wanted(const BakeSettings& settings) {
  const int max_triangles = triangles_wanted(settings);
  if (settings.base_triangles > max_triangles &&
      settings.origin("base_triangles") != Origin::fallback)
    throw Error(ErrorCode::command, fmt::format("--base-triangles {}", settings.base_triangles),
                fmt::format("The mesh may have no more than {} triangles.", max_triangles),
                "Give more with --triangles.");
  return std::min(settings.base_triangles, max_triangles);
}

int first_triangles(const BakeSettings& settings, const Pattern& pattern) {
  const int wanted = base_wanted(settings);
  if (settings.given.count("base_triangles") > 0 || settings.triangles) return wanted;
  const double finer = double(wanted) / BakeSettings{}.base_triangles;
  const int in_two_rows = static_cast<int>(finer * triangles_in_two_rows(pattern));
  return std::clamp(in_two_rows, wanted, std::max(wanted, CrumpleOptions{}.max_first_triangles));
}

MethodChoice make_method(const BakeSettings& settings, const Shot& shot, unsigned seed,
                         std::size_t sheet) {
  if (settings.method == "fem") return fem(triangles_wanted(settings));
  if (settings.method == "adaptive") return adaptive(shot.pattern, triangles_wanted(settings));
  CrumpleOptions options;
  options.singular_point_rules = shot.singular_point_rules;
  const int first = first_triangles(settings, shot.pattern);
  options.max_triangles =
      settings.triangles.value_or(std::max(triangles_wanted(settings), 2 * first));
  options.max_first_triangles =
      settings.triangles.value_or(std::max(options.max_first_triangles, options.max_triangles));
  return hybrid(shot.pattern, shot.paper, first, options, seed, static_cast<std::uint32_t>(sheet));
}

Polishing decided_polishing(const BakeSettings& settings) {
  constexpr int default_triangles = 6000;
  const bool by_method = settings.method == hybrid_and_fem;
  const char* option = by_method ? "--method hybrid+fem" : "--polish";
  if (by_method && settings.polish == 0)
    throw Error(ErrorCode::command, "--polish 0", "Frames of hybrid+fem are polished.",
                "Bake with --method hybrid.");
  if (const int wanted = settings.polish.value_or(0); wanted > 0 && wanted < min_polish_triangles)
    throw Error(ErrorCode::command, fmt::format("--polish {}", wanted),
                "A mesh of so few triangles is coarser than what it would refine.",
                fmt::format("Give at least {}, or 0 for no polish.", min_polish_triangles));
  if (by_method || settings.polish.value_or(0) > 0) {
    if (settings.method == "fem")
      throw Error(ErrorCode::command, option,
                  "There is nothing that fem could improve in its own frames.",
                  "For a finer mesh bake with --triangles N.");
    return {settings.polish.value_or(default_triangles), "asked for with " + std::string(option)};
  }
  if (settings.polish) return {0, "off with --polish 0"};
  const bool hero = settings.quality == Quality::hero && settings.mesh == CacheMesh::render;
  if (hero && settings.method == "hybrid") return {default_triangles, "--quality hero"};
  return {0, settings.method == "fem" ? "fem is at its minimum" : "not asked for"};
}

}  // namespace paperbake
