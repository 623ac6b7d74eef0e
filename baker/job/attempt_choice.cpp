#include "baker/job/attempt_choice.h"

#include "core/model/sheet.h"

#include <fmt/format.h>

namespace paperbake {
namespace {

/// What the paper of an attempt with singular points does.
const char* how_broken(const Attempt& attempt) {
  return attempt.points >= points_of_a_crumple ? "crumples" : "breaks at single points";
}

/// Why a finer one is not baked. The end of a sentence.
std::string why_not_better(const Attempt& finer, const Attempt& baked) {
  if (finer.points >= points_of_a_crumple || (baked.points > 0 && finer.points >= baked.points))
    return fmt::format("because the paper {} on one of {}{}", how_broken(finer),
                       finer.base_triangles, baked.points > 0 ? ", too" : "");
  return fmt::format("because one of {} is not better", finer.base_triangles);
}

}  // namespace

const char* name_of(AttemptReason reason) {
  switch (reason) {
    case AttemptReason::handle_off:
      return "handle off";
    case AttemptReason::crumpled:
      return "crumpled";
    case AttemptReason::coarse:
      return "coarse";
  }
  return "";
}

std::string why_doubted(const Attempt& attempt) {
  if (attempt.points == 0)
    return fmt::format("a first mesh of {} triangles puts the smooth paper off visibly",
                       attempt.base_triangles);
  return fmt::format("the paper {} on a first mesh of {} triangles", how_broken(attempt),
                     attempt.base_triangles);
}

std::string describe(const AttemptChoice& choice) {
  const Attempt &first = choice.tried.front(), &baked = choice.tried.at(choice.baked);
  if (choice.reason != AttemptReason::handle_off) {
    const std::string which =
        choice.baked == 0 ? "it is baked" : fmt::format("one of {} is baked", baked.base_triangles);
    std::string why;
    if (choice.tried.size() == 1)
      why = ", because none comes of a finer one";
    else if (choice.baked + 1 < choice.tried.size())
      why = ", " + why_not_better(choice.tried.back(), baked);
    return fmt::format("attempts: {}; {}{}", why_doubted(first), which, why);
  }
  std::string text =
      fmt::format("attempts: in the first attempt a handle is off by {:.1f} mm in frame {}",
                  1e3 * first.off, first.frame);
  const auto others = choice.tried.size() - 1;
  if (choice.hopeless)
    return text + fmt::format(
                      "; it is baked, because in all {} attempts a handle is off by {:g} % "
                      "of the sheet or more before the end, and they were given up",
                      choice.tried.size(), AttemptChoice::hopeless_pct);
  if (choice.baked == 0)
    return text + fmt::format("; it is baked, because {} {} not better", others,
                              others == 1 ? "other is" : "others are");
  text += fmt::format(
      "; attempt {} of {} is baked, where handles that paper can reach are off by {:.2g} mm at "
      "most",
      choice.baked + 1, choice.tried.size(), 1e3 * baked.off);
  if (baked.base_triangles != first.base_triangles)
    text += fmt::format(", on a first mesh of {} triangles", baked.base_triangles);
  // only the one that is tried because the others crumple has the seed of the bake, too
  if (const Attempt& last = choice.tried.back(); &last != &baked && last.seed_offset == 0)
    text += ", " + why_not_better(last, baked);
  return text;
}

}  // namespace paperbake
