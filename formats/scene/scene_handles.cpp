#include "formats/scene/scene_handles.h"

#include "core/model/error.h"
#include "formats/scene/scene_colliders.h"
#include "formats/scene/scene_properties.h"
#include "formats/scene/scene_winds.h"
#include "formats/scene/sheet_point.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace paperbake {
namespace {

/// Whether something moves sheets without handles.
bool sheets_move_alone(const SceneNodes& scene) {
  for (int i = 0; i < static_cast<int>(scene.file.nodes.size()); ++i)
    if (const ImportedNode& node = scene.file.nodes[i];
        is_collider(scene, i) || is_wind(node) || node.properties.count("paper_gravity") > 0)
      return true;
  return false;
}

constexpr double on_border = 1e-5;  // of the longer side
// [diagonals of the sheet] in one frame: more comes from a wrong unit or a wrong key
constexpr double max_jump = 4;
// a keyed scale below half also releases a handle: both formats can store that
constexpr double released_scale = 0.5;

struct HandleNode {
  int node;    // has the name and the properties
  int origin;  // its origin is the position: the node itself, or the child at a bone's tail
};

std::string place_of_handle(const SceneNodes& scene, const HandleNode& handle) {
  return place_of(scene.source, "handle", scene.file.nodes[handle.node].name);
}

std::vector<std::vector<int>> children_of(const std::vector<ImportedNode>& nodes) {
  std::vector<std::vector<int>> children(nodes.size());
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    int parent = nodes[i].parent;
    while (parent >= 0 && nodes[parent].pivot) parent = nodes[parent].parent;
    if (parent >= 0 && !nodes[i].pivot) children[parent].push_back(i);
  }
  return children;
}

int tail_of(const SceneNodes& scene, int bone, const std::vector<int>& children) {
  const auto& nodes = scene.file.nodes;
  for (int child : children)
    if (is_tail_leaf(nodes[child].name, nodes[bone].name)) return child;
  if (children.size() == 1) return children.front();
  throw Error(
      ErrorCode::scene, place_of(scene.source, "handle", nodes[bone].name),
      fmt::format("paper_point is tail, but the bone has {} children: its tail is not in the file.",
                  children.size()),
      "Export with \"Add leaf bones\", or parent an empty named handle... to the bone at its "
      "tail.");
}

/// What handles there are, if all are ignored.
Error no_handle(const SceneNodes& scene, const std::vector<std::string>& ignored) {
  if (!ignored.empty())
    return Error(
        ErrorCode::scene, scene.source,
        fmt::format("All handles of the scene are ignored: \"{}\"{}.", ignored.front(),
                    ignored.size() > 1 ? fmt::format(" and {} more", ignored.size() - 1) : ""),
        "Take paper_ignore, or ignore in a job file, from those that shall hold the sheet.");
  return Error(ErrorCode::scene, scene.source,
               "The scene has no handle: no node's name starts with \"handle\".",
               "Put an empty or a locator named handle... on the sheet at the first frame, and "
               "animate it. A sheet that falls or is blown needs none: give any object the "
               "property paper_gravity, or name an empty wind.");
}

std::vector<HandleNode> find_handles(const SceneNodes& scene) {
  const auto& nodes = scene.file.nodes;
  const auto children = children_of(nodes);
  std::vector<HandleNode> found;
  std::set<int> leaves;  // leaf nodes of bones that are handles: they are not handles themselves
  std::set<std::string> names;
  std::vector<std::string> ignored;
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    const auto point = text_property(nodes[i], "paper_point");
    if (nodes[i].pivot ||
        (!point && (leaves.count(i) || !name_begins_with(nodes[i].name, "handle"))))
      continue;
    const std::string place = place_of(scene.source, "handle", nodes[i].name);
    if (!names.insert(nodes[i].name).second)
      throw Error(ErrorCode::scene, place, "Two handles have this name.",
                  "Give every handle a name of its own and export again.");
    const std::string side = point ? matched_name(*point) : "head";
    if (side != "head" && side != "tail")
      throw Error(ErrorCode::scene, place, fmt::format("paper_point is \"{}\".", *point),
                  "It must be head or tail.");
    if (flag_property(nodes[i], "paper_ignore"))
      ignored.push_back(nodes[i].name);
    else
      found.push_back({i, side == "tail" ? tail_of(scene, i, children[i]) : i});
    for (int child : children[i])
      if (children[child].empty() && is_tail_leaf(nodes[child].name, nodes[i].name))
        leaves.insert(child);
  }
  // without handles the sheet may still fall, or be blown away
  if (found.empty() && !sheets_move_alone(scene)) throw no_handle(scene, ignored);
  return found;
}

/// Moves a point that is within rounding of a corner or the border onto it.
Vector2d snapped_to_border(const Pattern& pattern, const Vector2d& p) {
  const double near = on_border * longer_side(pattern);
  const auto corner_near = [&](const std::vector<Vector2d>& loop) {
    return std::find_if(loop.begin(), loop.end(),
                        [&](const Vector2d& corner) { return (corner - p).norm() <= near; });
  };
  if (const auto corner = corner_near(pattern.outline); corner != pattern.outline.end())
    return *corner;
  for (const auto& hole : pattern.holes)
    if (const auto corner = corner_near(hole); corner != hole.end()) return *corner;
  const Vector2d border = nearest_border_point(pattern, p);
  return (border - p).norm() <= near ? border : p;
}

struct HandleAttachment {
  std::size_t sheet;
  SheetPoint point;
};

HandleAttachment attach(const SceneNodes& scene, const std::vector<SceneSheet>& sheets,
                        const HandleNode& handle, const Vector3d& at) {
  HandleAttachment attachment{0, {}};
  if (const auto target =
          target_sheet(scene, sheets, handle.node, place_of_handle(scene, handle))) {
    attachment.sheet = *target;
    attachment.point = nearest_point(sheets[attachment.sheet].start, at);
  } else {
    for (std::size_t i = 0; i < sheets.size(); ++i) {
      const SheetPoint point = nearest_point(sheets[i].start, at);
      if (point.distance < attachment.point.distance) attachment = {i, point};
    }
  }
  const SceneSheet& sheet = sheets[attachment.sheet];
  const double diagonal = extent(sheet.pattern).norm();
  if (attachment.point.distance > diagonal)
    throw Error(
        ErrorCode::scene,
        fmt::format("{}, frame {}", place_of_handle(scene, handle), scene.first_frame),
        fmt::format("The handle is {:.3g} m away from the sheet \"{}\", which is {:.3g} m across.",
                    attachment.point.distance, sheet.name, diagonal),
        "Put the handle on its sheet point at the first frame, or name its sheet in paper_target.");
  return attachment;
}

void read_properties(const SceneNodes& scene, const HandleNode& found, Handle& handle) {
  const ImportedNode& node = scene.file.nodes[found.node];
  const std::string& source = scene.source;
  const std::string mode = matched_name(text_property(node, "paper_mode").value_or("absolute"));
  if (mode != "absolute" && mode != "relative")
    throw Error(ErrorCode::scene, place_of_handle(scene, found),
                fmt::format("paper_mode is \"{}\".", mode), "It must be absolute or relative.");
  handle.mode = mode == "relative" ? HandleMode::relative : HandleMode::absolute;
  handle.grab_frame = whole_property(source, node, "paper_grab_frame").value_or(handle.grab_frame);
  handle.release_frame =
      whole_property(source, node, "paper_release_frame").value_or(handle.release_frame);
  handle.radius = nonnegative_property(source, node, "paper_radius");
  handle.stiffness = nonnegative_property(source, node, "paper_stiffness").value_or(0);
}

/// Sets the keyed positions over the frames of the scene, and releases handles where their scale
/// falls below half of that at the first frame. Returns which handles are released so.
std::vector<bool> read_motion(const SceneNodes& scene, const std::vector<HandleNode>& found,
                              std::vector<Handle>& handles) {
  const auto size = [](const Eigen::Affine3d& world) {
    return std::cbrt(std::abs(world.linear().determinant()));
  };
  const int frames = scene.last_frame - scene.first_frame + 1;
  std::vector<double> first_size(found.size());
  std::vector<int> shrunk(found.size(), std::numeric_limits<int>::max());
  for (int f = 0; f < frames; ++f) {
    const auto world = world_at(scene, scene.first_frame + f);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (f == 0) {
        handles[i].keyed.resize(frames, 3);
        first_size[i] = size(world[found[i].node]);
      }
      handles[i].keyed.row(f) = origin_of(scene, world, found[i].origin);
      if (size(world[found[i].node]) < released_scale * first_size[i])
        shrunk[i] = std::min(shrunk[i], scene.first_frame + f);
    }
  }
  std::vector<bool> by_scale(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    by_scale[i] = handles[i].release_frame == std::numeric_limits<int>::max() &&
                  shrunk[i] != std::numeric_limits<int>::max();
    if (by_scale[i]) handles[i].release_frame = shrunk[i];
  }
  return by_scale;
}

void check_jumps(const SceneNodes& scene, const HandleNode& found, const Handle& handle,
                 const SceneSheet& sheet) {
  const double diagonal = extent(sheet.pattern).norm();
  for (int f = 1; f < handle.keyed.rows(); ++f) {
    const double jump = (handle.keyed.row(f) - handle.keyed.row(f - 1)).norm();
    if (!(jump > max_jump * diagonal)) continue;
    const int frame = scene.first_frame + f;
    throw Error(
        ErrorCode::scene,
        fmt::format("{}, frames {}-{}", place_of_handle(scene, found), frame - 1, frame),
        fmt::format("The handle jumps {:.3g} m in one frame; the sheet \"{}\" is {:.3g} m across.",
                    jump, sheet.name, diagonal),
        "Look for a wrong key there; if everything is too large, the unit of the file is wrong: "
        "--unit-scale.");
  }
}

void warn_of_odd_handle(const SceneNodes& scene, const Handle& handle, SceneSheet& sheet,
                        double distance, std::vector<std::string>& warnings) {
  constexpr double beside = 1e-3;  // [m] the gate of handles is as strict
  if (handle.mode == HandleMode::absolute && distance > beside) {
    sheet.handles_off.push_back(
        fmt::format("The handle \"{}\" is {:.3g} mm away from its sheet at frame {}: it pulls the "
                    "nearest sheet point.",
                    handle.name, 1000 * distance, scene.first_frame));
    warnings.push_back(sheet.handles_off.back() +
                       " Move it onto the sheet, or give it the property paper_mode = "
                       "\"relative\", by which it moves the point as far as it moves itself.");
  }
  if (const double diagonal = extent(sheet.pattern).norm();
      handle.radius && *handle.radius > diagonal)
    warnings.push_back(
        fmt::format("The handle \"{}\" holds all of the sheet \"{}\" stiff: its paper_radius is "
                    "{:.3g} m, and the sheet is {:.3g} m across. It is in metres: is that meant?",
                    handle.name, sheet.name, *handle.radius, diagonal));
  if (handle.release_frame <= scene.first_frame && handle.grab_frame < handle.release_frame)
    warnings.push_back(fmt::format(
        "The handle \"{}\" never holds: it is released at frame {}, and the scene begins at {}.",
        handle.name, handle.release_frame, scene.first_frame));
  if (handle.release_frame <= handle.grab_frame)
    warnings.push_back(
        fmt::format("The handle \"{}\" never holds: it is released at frame {} and grabbed at {}.",
                    handle.name, handle.release_frame, handle.grab_frame));
}

/// Warns of nodes that group handles and are taken for handles because of their own name.
void warn_of_groups(const SceneNodes& scene, const std::vector<HandleNode>& found,
                    std::vector<std::string>& warnings) {
  const auto& nodes = scene.file.nodes;
  std::map<int, int> below;
  for (const HandleNode& handle : found) {
    int parent = nodes[handle.node].parent;
    while (parent >= 0 && nodes[parent].pivot) parent = nodes[parent].parent;
    ++below[parent];
  }
  for (const HandleNode& handle : found)
    if (const auto group = below.find(handle.node); group != below.end() && group->second > 1)
      warnings.push_back(
          fmt::format("The handle \"{}\" has {} handles below it and holds the sheet, too: if "
                      "it only groups them, rename it or give it paper_ignore.",
                      nodes[handle.node].name, group->second));
}

/// Warns of things that are likely to be taken for handles by mistake, such as a "handlebar".
void warn_of_props(const SceneNodes& scene, const std::vector<HandleNode>& found,
                   std::vector<std::string>& warnings) {
  for (const HandleNode& handle : found)
    if (const ImportedNode& node = scene.file.nodes[handle.node];
        !node.meshes.empty() && is_longer_word(node.name, "handle"))
      warnings.push_back(
          fmt::format("The mesh \"{}\" is taken for a handle, because its name begins with "
                      "\"handle\": if it is none, rename it or give it paper_ignore.",
                      node.name));
}

void warn_of_stillness(const SceneNodes& scene, const std::vector<Handle>& handles,
                       std::vector<std::string>& warnings) {
  const auto still = [](const Handle& handle) {
    return handle.release_frame == std::numeric_limits<int>::max() &&  // a fall is a motion
           (handle.keyed.rowwise() - handle.keyed.row(0)).cwiseAbs().maxCoeff() < 1e-9;
  };
  if (handles.empty() || !std::all_of(handles.begin(), handles.end(), still)) return;
  const auto lets_go = [](const Handle& handle) {
    return handle.release_frame < std::numeric_limits<int>::max();
  };
  if (std::any_of(handles.begin(), handles.end(), lets_go) || sheets_move_alone(scene)) return;
  warnings.push_back(scene.file.takes.empty()
                         ? "No handle moves: the file has no animation."
                         : "No handle moves: no animation of the file belongs to one.");
}

void warn_of_loose_sheets(const std::vector<SceneSheet>& sheets,
                          std::vector<std::string>& warnings) {
  std::vector<std::string> loose;
  for (const SceneSheet& sheet : sheets) {
    if (!sheet.handles.empty()) continue;
    if (is_longer_word(sheet.name, "paper"))
      warnings.push_back(
          fmt::format("The sheet \"{}\" has no handle: nothing holds it. If it is no "
                      "sheet, rename it or give it paper_ignore.",
                      sheet.name));
    else
      loose.push_back(sheet.name);
  }
  if (loose.size() == 1)
    warnings.push_back(
        fmt::format("The sheet \"{}\" has no handle: nothing holds it.", loose.front()));
  else if (!loose.empty())
    warnings.push_back(fmt::format("{} sheets have no handle, nothing holds them: \"{}\".",
                                   loose.size(), fmt::join(loose, "\", \"")));
}

}  // namespace

void add_handles(const SceneNodes& scene, std::vector<SceneSheet>& sheets,
                 std::vector<std::string>& warnings) {
  const std::vector<HandleNode> found = find_handles(scene);
  std::vector<Handle> handles(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    handles[i].name = scene.file.nodes[found[i].node].name;
    read_properties(scene, found[i], handles[i]);
  }
  const std::vector<bool> by_scale = read_motion(scene, found, handles);
  warn_of_groups(scene, found, warnings);
  warn_of_props(scene, found, warnings);
  warn_of_stillness(scene, handles, warnings);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const HandleAttachment attachment = attach(scene, sheets, found[i], handles[i].keyed.row(0));
    SceneSheet& sheet = sheets[attachment.sheet];
    handles[i].pattern = snapped_to_border(sheet.pattern, attachment.point.pattern);
    check_jumps(scene, found[i], handles[i], sheet);
    warn_of_odd_handle(scene, handles[i], sheet, attachment.point.distance, warnings);
    if (by_scale[i]) sheet.scale_releases.insert(handles[i].name);
    sheet.handles.push_back(std::move(handles[i]));
  }
  warn_of_loose_sheets(sheets, warnings);
}

}  // namespace paperbake
