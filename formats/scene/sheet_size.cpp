#include "formats/scene/sheet_size.h"

#include "core/model/error.h"
#include "formats/scene/scene_properties.h"
#include "formats/scene/sheet_rules.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <optional>

namespace paperbake {
namespace {

// [m] limits of the longer side, beyond which the unit of the file must be wrong
constexpr double max_sheet_side = 5, min_sheet_side = 0.005;
// [m] longer sides of the sheets that are animated: a snippet or a postage stamp is longer than the
// first, and the longest of the standard sizes, A0 with 1.189 m, is shorter than the second
constexpr double least_usual_side = 0.01, most_usual_side = 1.2;
constexpr double size_agreement = 0.01;  // relative tolerance of paper_size

struct LengthUnit {
  const char* name;
  double metres;
};
constexpr LengthUnit length_units[] = {
    {"millimetres", 0.001}, {"centimetres", 0.01}, {"inches", 0.0254}, {"metres", 1}};

/// The size in paper_size, with the two sides exchanged where that fits the measured size better;
/// nothing without that property.
std::optional<Vector2d> stated_size(const ImportedNode& node, const Vector2d& measured) {
  const auto list = list_property(node, "paper_size");
  if (list.size() < 2 || !(list[0] > 0) || !(list[1] > 0)) return std::nullopt;
  const Vector2d stated(list[0], list[1]), turned(list[1], list[0]);
  const auto off = [&](const Vector2d& size) {
    return (measured.cwiseQuotient(size).array().log()).matrix().squaredNorm();
  };
  return off(turned) < off(stated) ? turned : stated;
}

/// "101.6 x 76.2 mm": the size of the sheet if the file were in another unit.
std::string size_in(const SceneNodes& scene, const LengthUnit& unit, const Vector2d& size) {
  const Vector2d mm = 1e3 * unit.metres / scene.unit * size;
  return fmt::format("{:.4g} x {:.4g} mm", mm.x(), mm.y());
}

/// The units in which the sheet would have a usual size.
std::vector<LengthUnit> usual_units(const SceneNodes& scene, const Vector2d& size) {
  std::vector<LengthUnit> usual;
  for (const LengthUnit& unit : length_units) {
    const double factor = unit.metres / scene.unit, longer = factor * size.maxCoeff();
    if (std::abs(factor - 1) > 1e-6 && least_usual_side <= longer && longer <= most_usual_side)
      usual.push_back(unit);
  }
  return usual;
}

/// The unit by which the sheet would be as large as paper_size says: a known one, or one that is
/// wrong by a power of ten and has no name here.
std::optional<LengthUnit> stated_unit(const SceneNodes& scene, const Vector2d& size,
                                      const Vector2d& stated) {
  const double factor = stated.maxCoeff() / size.maxCoeff();
  const auto fits = [&](double unit) {
    return std::abs(factor * scene.unit / unit - 1) <= size_agreement;
  };
  if (fits(scene.unit)) return std::nullopt;
  for (const LengthUnit& unit : length_units)
    if (fits(unit.metres)) return unit;
  const double power = scene.unit * std::pow(10, std::round(std::log10(factor)));
  return fits(power) ? std::optional(LengthUnit{"", power}) : std::nullopt;
}

/// What to do if the file is in one of these units.
std::string unit_remedy(const SceneNodes& scene, const std::vector<LengthUnit>& units,
                        const Vector2d& size) {
  if (units.empty())
    return "The unit of the file is probably wrong: bake with --unit-scale and the length of one "
           "unit of the file in metres, or export in metres.";
  if (units.size() == 1) {
    const LengthUnit& unit = units.front();
    const std::string guess = *unit.name ? fmt::format("The file is probably in {}", unit.name)
                                         : "The unit of the file is probably wrong";
    return fmt::format(
        "{}: bake with --unit-scale {:.6g}, with which the sheet is {}, or export {:.6g} times as "
        "large.",
        guess, unit.metres, size_in(scene, unit, size), unit.metres / scene.unit);
  }
  std::vector<std::string> sizes;
  for (const LengthUnit& unit : units)
    sizes.push_back(fmt::format("{} in {} (--unit-scale {:.6g})", size_in(scene, unit, size),
                                unit.name, unit.metres));
  return fmt::format(
      "In which unit is the file? The sheet would be {}. Bake with the right one, or export in "
      "metres.",
      fmt::join(sizes, ", "));
}

}  // namespace

void check_size(const SceneNodes& scene, const ImportedNode& node, const Vector2d& size,
                const SceneOptions& options, std::vector<std::string>& warnings) {
  const std::string place = place_of(scene.source, "sheet", node.name);
  const double longer = size.maxCoeff();
  const auto stated = stated_size(node, size);
  const auto unit = stated ? stated_unit(scene, size, *stated) : std::nullopt;
  const auto remedy = [&] {
    return unit_remedy(scene, unit ? std::vector{*unit} : usual_units(scene, size), size);
  };
  constexpr double rounding = 1e-6;  // [1] of a file's single precision
  if (longer > (1 + rounding) * max_sheet_side || longer < (1 - rounding) * min_sheet_side)
    throw Error(ErrorCode::scene, place,
                fmt::format("The sheet is {}; a sheet's longer side is between 5 mm and 5 m.",
                            metres(size)),
                options.unit_scale ? std::string("Bake with another --unit-scale.") : remedy());
  if (!stated) {
    if (!options.unit_scale && longer > most_usual_side)
      warnings.push_back(fmt::format("The sheet \"{}\" is {}, longer than A0: is that meant? {}",
                                     node.name, metres(size), remedy()));
    return;
  }
  if ((size.cwiseQuotient(*stated).array() - 1).abs().maxCoeff() <= size_agreement) return;
  throw Error(ErrorCode::scene, place,
              fmt::format("The sheet is {}, but its property paper_size says {}.", metres(size),
                          metres(*stated)),
              unit ? remedy() : "Correct paper_size or the mesh; they must agree within 1 %.");
}

}  // namespace paperbake
