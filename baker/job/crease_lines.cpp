#include "baker/job/crease_lines.h"

#include "core/hands/fold_axis.h"
#include "core/model/degrees.h"
#include "core/model/segment2.h"
#include "formats/config/job_file.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {
namespace {

/// The first handle on each side stands for all: an artist finds the others beside it.
std::string origin_of(const ExpectedCrease& crease, const std::vector<Handle>& handles) {
  const auto name = [&](const std::vector<int>& group) {
    return fmt::format("\"{}\" and {} more", handles[group.front()].name, group.size() - 1);
  };
  using By = ExpectedCrease::By;
  const char* form = crease.by == By::two_plates      ? "clamps {}, {}"
                     : crease.by == By::plate_and_row ? "clamp {}, row {}"
                                                      : "between the folds of {}, {}";
  return fmt::format(fmt::runtime(form), name(crease.plate), name(crease.other));
}

/// [m] How far the corners of a line are from another one, at most.
double distance(const std::vector<Vector2d>& corners, const std::vector<Vector2d>& line) {
  double most = 0;
  for (const Vector2d& p : corners) {
    double least = (p - line.front()).norm();
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
      least = std::min(least, distance_to_segment(p, line[k], line[k + 1]));
    most = std::max(most, least);
  }
  return most;
}

}  // namespace

std::vector<ExpectedCrease> expected_creases(const SceneSheet& sheet, int first_frame) {
  return expected_creases({sheet.name, sheet.pattern, sheet.start, sheet.handles, Paper{}},
                          first_frame);
}

std::vector<CreaseLine> crease_lines(const SceneSheet& sheet,
                                     const std::vector<ExpectedCrease>& expected) {
  std::vector<CreaseLine> lines;
  const std::vector<PrescribedCrease> drawn = drawn_creases(sheet.pattern, expected);
  for (std::size_t c = 0; c < drawn.size(); ++c) {
    std::string origin = sheet.crease_origin[c];
    double moved = 0;  // not of a crease of which only an end lies on one that hands fold
    for (const ExpectedCrease& crease : expected)
      if (std::count(crease.creases.begin(), crease.creases.end(), static_cast<int>(c)) > 0) {
        origin += fmt::format("; turned by {:.4g} degrees by {}", degrees_of(largest_turn(crease)),
                              origin_of(crease, sheet.handles));
        moved = distance(sheet.pattern.prescribed_creases[c].line, drawn[c].line);
      }
    lines.push_back({drawn[c].line, drawn[c].angle, false, origin, moved});
  }
  for (const ExpectedCrease& crease : expected)
    for (const Segment2& part : crease.missing)
      lines.push_back(
          {{part.a, part.b}, largest_turn(crease), true, origin_of(crease, sheet.handles)});
  return lines;
}

std::vector<std::string> describe_moved(const std::string& sheet, double longer_side,
                                        const std::vector<CreaseLine>& lines) {
  std::vector<std::string> sentences;
  for (std::size_t k = 0; k < lines.size(); ++k)
    if (lines[k].moved > on_line * longer_side)
      sentences.push_back(fmt::format(
          "Crease {} of \"{}\" is moved by up to {:.1f} mm, onto the line about which the handles "
          "turn the paper: beside that line, paper would be missing. If it is to fold where it is "
          "drawn, key them about the drawn line.",
          k + 1, sheet, 1e3 * lines[k].moved));
  return sentences;
}

std::string describe(const CreaseLine& crease, std::size_t number) {
  const auto point = [](const Vector2d& p) {
    return fmt::format("({:.2f}, {:.2f})", 1e3 * p.x(), 1e3 * p.y());
  };
  const std::string bends =
      crease.line.size() == 2 ? "" : fmt::format(", {} bend(s)", crease.line.size() - 2);
  return fmt::format("crease {} from {} to {} mm{}, {} {:.4g} degrees: {}", number,
                     point(crease.line.front()), point(crease.line.back()), bends,
                     crease.expected ? "expected: turns by" : "springs back to",
                     degrees_of(crease.angle), crease.origin);
}

std::string toml_expected(const std::vector<CreaseLine>& lines) {
  std::vector<CreaseLine> expected;
  for (const CreaseLine& line : lines)
    if (line.expected) expected.push_back(line);
  return toml_list(expected, [](const CreaseLine& c) {
    return fmt::format("{{line = {}, angle = {}, from = {}}}", toml_list(c.line, toml_point),
                       toml_number(degrees_of(c.angle)), toml_string(c.origin));
  });
}

}  // namespace paperbake
