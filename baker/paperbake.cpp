#include "baker/paperbake.h"

#include "baker/bake/bake.h"
#include "baker/job/options.h"
#include "baker/job/plan.h"
#include "baker/output/progress.h"
#include "baker/studies/accuracy_search.h"
#include "formats/config/nearest_word.h"
#include "formats/config/preset_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace paperbake {
namespace {

void check_handle(const Handle& handle, const SceneSheet& sheet) {
  const std::string place = fmt::format("sheet \"{}\", handle \"{}\"", sheet.name, handle.name);
  if (handle.keyed.rows() == 0 || !handle.keyed.allFinite())
    throw Error(ErrorCode::scene, place, "Its positions are missing or not finite.",
                "Handle::keyed needs one row for each frame from the scene's first.");
  if (!contains(sheet.pattern, handle.pattern, 1e-6 * longer_side(sheet.pattern)))
    throw Error(ErrorCode::scene, place,
                fmt::format("Its point ({:.4g}, {:.4g}) m is not on the pattern.",
                            handle.pattern.x(), handle.pattern.y()),
                "Handle::pattern is a point of the flat sheet in metres.");
}

void check_sheet(const SceneSheet& sheet) {
  const std::string place = fmt::format("sheet \"{}\"", sheet.name);
  const auto& outline = sheet.pattern.outline;
  if (outline.size() < 3 || !(area(sheet.pattern) > 0))
    throw Error(ErrorCode::scene, place, "The outline of its pattern has no area.",
                "Pattern::outline is counter-clockwise and has at least three corners.");
  Vector2d corner = outline.front();
  for (const Vector2d& p : outline) corner = corner.cwiseMin(p);
  if (corner.cwiseAbs().maxCoeff() > 1e-6 * longer_side(sheet.pattern))
    throw Error(ErrorCode::scene, place,
                fmt::format("The bounding box of its pattern begins at ({:.4g}, {:.4g}) m.",
                            corner.x(), corner.y()),
                "Move the pattern so that it begins at (0, 0).");
  const Sheet& start = sheet.start;
  if (start.x.rows() == 0 || start.x.rows() != start.pattern.rows() || !start.x.allFinite() ||
      start.triangles.rows() == 0 || start.triangles.minCoeff() < 0 ||
      start.triangles.maxCoeff() >= start.x.rows())
    throw Error(
        ErrorCode::scene, place, "The mesh of its first frame is empty or does not fit together.",
        "SceneSheet::start has a row of pattern and one of x for each vertex, and triangles "
        "of their indices.");
  for (const Handle& handle : sheet.handles) check_handle(handle, sheet);
}

/// What read_scene() makes sure of in a file.
void check_scene(const Scene& scene) {
  const std::string place = scene.source.empty() ? "scene" : scene.source;
  if (scene.sheets.empty())
    throw Error(ErrorCode::scene, place, "There is no sheet.", "Add one to Scene::sheets.");
  if (!(scene.fps > 0) || scene.last_frame < scene.first_frame)
    throw Error(ErrorCode::scene, place,
                fmt::format("Frames {}-{} at {} frames a second cannot be.", scene.first_frame,
                            scene.last_frame, scene.fps),
                "Set Scene::first_frame, last_frame and fps.");
  for (std::size_t s = 0; s < scene.sheets.size(); ++s) {
    check_sheet(scene.sheets[s]);
    for (std::size_t other = 0; other < s; ++other)
      if (scene.sheets[other].name == scene.sheets[s].name)
        throw Error(ErrorCode::scene, place,
                    fmt::format("Two sheets are called \"{}\".", scene.sheets[s].name),
                    "Give each a name of its own.");
  }
}

/// throws Error(ErrorCode::command) when there is no such option, or it is not one of a scene that
/// has been read
const Option& option_called(const std::string& name) {
  const std::vector<std::string> settled{"scene",       "output",     "progress", "fps",
                                         "start_frame", "unit_scale", "take"};
  const std::string place = fmt::format("option \"{}\"", name);
  if (std::count(settled.begin(), settled.end(), name))
    throw Error(ErrorCode::command, place, "The scene has been read, and the call says the rest.",
                "Say it to read_scene(), or in the Scene.");
  std::vector<std::string> names;
  for (const Option& option : options()) {
    if (option.name == name) return option;
    names.push_back(option.name);
  }
  throw Error(ErrorCode::command, place, "There is no such option." + did_you_mean(name, names),
              "docs/command_line.md has all options of bake.");
}

BakeSettings settings_of(const Scene& scene, const BakeJob& job) {
  BakeSettings settings;
  settings.scene = scene.source.empty() ? "scene" : scene.source;
  settings.progress = ProgressMode::none;
  for (const auto& [name, text] : job.options)
    apply_option(settings, option_called(name), text, fmt::format("option \"{}\"", name),
                 Origin::job);
  for (const auto& [name, value] : job.paper)
    settings.set.push_back(parse_set(fmt::format("{}={}", name, value)));
  return settings;
}

}  // namespace

SceneSheet flat_sheet(std::string name, double width, double height) {
  if (!(width > 0) || !(height > 0))
    throw Error(ErrorCode::scene, fmt::format("sheet \"{}\"", name),
                fmt::format("It would be {} m by {} m.", width, height), "");
  SceneSheet sheet;
  sheet.name = std::move(name);
  sheet.pattern.outline = {{0, 0}, {width, 0}, {width, height}, {0, height}};
  sheet.start.pattern.resize(4, 2);
  for (int v = 0; v < 4; ++v) sheet.start.pattern.row(v) = sheet.pattern.outline[v];
  sheet.start.x = Points3::Zero(4, 3);
  sheet.start.x.leftCols<2>() = sheet.start.pattern;
  sheet.start.triangles.resize(2, 3);
  sheet.start.triangles << 0, 1, 2, 0, 2, 3;
  return sheet;
}

void simulate_scene(const Scene& scene, const BakeJob& job,
                    const std::function<bool(const AnimatedFrame&)>& on_frame) {
  check_scene(scene);
  BakeSettings settings = settings_of(scene, job);
  settings.attempts = 1;
  const BakePlan plan = plan_with_accuracy(
      settings, [](const std::string&) {},
      [&](const BakeSettings& with) { return plan_bake(with, scene); });
  simulate(plan, options_of_sheets(plan), settings.threads, [&](const AnimatedFrame& frame) {
    return !plan.frames.contains(frame.frame) || on_frame(frame);
  });
}

BakeResult bake_scene(const Scene& scene, const std::filesystem::path& folder, const BakeJob& job,
                      const BakeCallbacks& callbacks) {
  check_scene(scene);
  BakeSettings settings = settings_of(scene, job);
  settings.output = folder;
  const BakePlan plan = plan_with_accuracy(
      settings,
      [&](const std::string& sentence) {
        if (callbacks.on_message) callbacks.on_message(sentence);
      },
      [&](const BakeSettings& with) { return plan_bake(with, scene); });
  const FrameSpan& span = plan.frames;
  const int frames =
      static_cast<int>(plan.shots.size()) * ((span.last - span.first) / span.step + 1);
  Progress progress(
      [&](const ProgressStep& step) {
        if (callbacks.on_progress)
          callbacks.on_progress({step.pass, step.sheet, step.frame, step.done, step.frames});
      },
      callbacks.on_message, frames, passes_of(settings));
  print_warnings(plan, progress);
  BakeOutcome outcome = bake(settings, plan, progress, callbacks.cancel);
  return {std::move(outcome.files), std::move(outcome.missed)};
}

}  // namespace paperbake
