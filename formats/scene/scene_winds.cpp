#include "formats/scene/scene_winds.h"

#include "core/geometry/measure.h"
#include "core/model/error.h"
#include "formats/scene/scene_properties.h"

#include <fmt/format.h>

#include <cctype>

namespace paperbake {
namespace {

/// The axis of a node along which its wind blows.
Vector3d axis_of(const SceneNodes& scene, const ImportedNode& node) {
  const auto given = text_property(node, "paper_axis");
  if (!given) return scene.file.fbx ? Vector3d::UnitZ() : Vector3d::UnitY();
  std::string text = *given;
  double sign = 1;
  if (text.size() == 2 && (text[0] == '-' || text[0] == '+')) {
    sign = text[0] == '-' ? -1 : 1;
    text.erase(0, 1);
  }
  const std::size_t axis = text.size() == 1
                               ? std::string("xyz").find(static_cast<char>(std::tolower(text[0])))
                               : std::string::npos;
  if (axis == std::string::npos)
    throw Error(ErrorCode::scene, place_of(scene.source, "wind", node.name),
                fmt::format("paper_axis is \"{}\".", *given),
                "It must be x, y or z, with a minus sign for the other way.");
  return sign * Vector3d::Unit(static_cast<Eigen::Index>(axis));
}

}  // namespace

bool is_wind(const ImportedNode& node) {
  if (!node.meshes.empty() || node.pivot || !name_begins_with(node.name, "wind")) return false;
  const std::string name = matched_name(node.name);
  return name.size() == 4 || !std::isalpha(static_cast<unsigned char>(name[4])) ||
         node.properties.count("paper_speed") > 0;
}

std::vector<Wind> read_winds(const SceneNodes& scene) {
  std::vector<Wind> winds;
  std::vector<int> found;
  std::vector<Vector3d> axes;
  const auto& nodes = scene.file.nodes;
  const int frames = scene.last_frame - scene.first_frame + 1;
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
    if (!is_wind(nodes[i])) continue;
    Wind wind;
    wind.name = nodes[i].name;
    wind.velocity = Points3::Zero(frames, 3);
    wind.gust = nonnegative_property(scene.source, nodes[i], "paper_gust").value_or(0);
    wind.seed =
        static_cast<unsigned>(whole_property(scene.source, nodes[i], "paper_seed").value_or(0));
    found.push_back(i);
    axes.push_back(axis_of(scene, nodes[i]));
    winds.push_back(std::move(wind));
  }
  for (int f = 0; f < frames && !found.empty(); ++f) {
    const auto world = world_at(scene, scene.first_frame + f);
    for (std::size_t w = 0; w < found.size(); ++w)
      winds[w].velocity.row(f) = world[found[w]].linear() * axes[w];
  }
  for (std::size_t w = 0; w < found.size(); ++w) {
    const double speed =
        nonnegative_property(scene.source, nodes[found[w]], "paper_speed").value_or(1);
    const double largest = max_row_norm(winds[w].velocity);
    if (largest > 0) winds[w].velocity *= speed / largest;
  }
  return winds;
}

}  // namespace paperbake
