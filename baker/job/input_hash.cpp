#include "baker/job/input_hash.h"

#include "baker/job/version.h"
#include "core/geometry/collider.h"
#include "core/hands/folding_hands.h"
#include "formats/cache/content_hash.h"
#include "formats/files/bytes_of.h"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <iterator>

namespace paperbake {
namespace {

std::string start_bytes(const Shot& shot, unsigned seed, const std::string& settings) {
  std::string bytes = settings + shot.sheet_name + fmt::format("/{}/", seed);
  for (const Vector2d& p : shot.pattern.outline) bytes += bytes_of_values(p);
  for (const auto& hole : shot.pattern.holes)
    for (const Vector2d& p : hole) bytes += bytes_of_values(p);
  bytes += bytes_of_values(shot.start.pattern);
  bytes += bytes_of_values(shot.start.x);
  bytes += bytes_of_values(shot.start.triangles);
  for (const Vector2d& p : shot.singular_point_rules.fixed) {
    bytes += "keep";
    bytes += bytes_of_values(p);
  }
  for (const Disc& disc : shot.singular_point_rules.forbidden) {
    bytes += fmt::format("forbid/{}/", disc.radius);
    bytes += bytes_of_values(disc.centre);
  }
  for (const PrescribedCrease& fold : shot.pattern.prescribed_creases) {
    bytes += fmt::format("fold/{}/{}/", fold.angle, fold.folded);
    for (const Vector2d& p : fold.line) bytes += bytes_of_values(p);
  }
  for (const Handle& handle : shot.handles) {
    bytes += fmt::format("{}/{}/{}/{}/{}/{}/", handle.name, int(handle.mode), handle.grab_frame,
                         handle.release_frame, handle.radius.value_or(-1), handle.stiffness);
    bytes += bytes_of_values(handle.pattern);
  }
  for (const FoldingHands& hands : shot.hands) {
    const auto add = [&](const Segment2& part) {
      bytes += bytes_of_values(part.a);
      bytes += bytes_of_values(part.b);
    };
    bytes += "hands";
    add(hands.line);
    for (const Segment2& part : hands.parts) add(part);
    bytes += bytes_of_values(hands.between);
    if (hands.beyond) bytes += fmt::format("beyond/{}/{}", hands.beyond->own, hands.beyond->others);
  }
  if (shot.colliders)
    for (const Collider& collider : *shot.colliders) {
      bytes += fmt::format("{}/{}/", collider.mesh().name, collider.mesh().friction);
      bytes += bytes_of_values(collider.mesh().x);
      bytes += bytes_of_values(collider.mesh().triangles);
    }
  return bytes;
}

/// Bytes of what the caches carry along and the simulation does not look at.
std::string authored_bytes(const Shot& shot) {
  std::string bytes;
  if (!shot.authored) return bytes;
  for (const AuthoredAttribute& a : shot.authored->attributes) {
    bytes += a.kind == AttributeKind::uv
                 ? fmt::format("uv/{}/", a.name)
                 : fmt::format("{}/{}/{}/", int(a.kind), a.values.cols(), a.name);
    bytes += bytes_of_values(a.values);
  }
  for (const std::string& material : shot.authored->materials) bytes += "material/" + material;
  for (const int material : shot.authored->material_of) bytes += fmt::format("/{}", material);
  for (const auto& [key, value] : shot.authored->properties) {
    bytes += fmt::format("/{}/{}/", key, value.index());
    if (const auto* text = std::get_if<std::string>(&value))
      bytes += *text;
    else if (const auto* list = std::get_if<std::vector<double>>(&value))
      bytes += fmt::format("{}", fmt::join(*list, ","));
    else
      bytes += fmt::format("{}", std::get<double>(value));
  }
  return bytes;
}

/// Is this a value that no simulated frame depends on?
bool is_of_output(const std::string& key) {
  const char* const keys[] = {"scene.file",      "scene.last_frame", "bake.frames",
                              "bake.mesh",       "bake.quality",     "bake.map_size",
                              "bake.map_layout", "bake.max_stretch", "bake.strict"};
  return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
}

/// For several sheets, which may touch, the hash of each with those of all; for one, its own.
std::vector<std::string> with_all(std::vector<std::string> hashes) {
  std::string all;
  for (const std::string& hash : hashes) all += hash;
  if (hashes.size() > 1)
    for (std::string& hash : hashes) hash = hex(content_hash(hash + all));
  return hashes;
}

/// Of the frames that are baked, and of those after them that have keys.
int rows_of(const BakePlan& plan) {
  std::ptrdiff_t rows = plan.animation.last_frame - plan.animation.first_frame + 1;
  for (const Shot& shot : plan.shots) {
    for (const Handle& handle : shot.handles) rows = std::max(rows, handle.keyed.rows());
    if (!shot.colliders) continue;
    for (const Collider& collider : *shot.colliders)
      rows = std::max(rows, std::ptrdiff_t(collider.frames().size()));
  }
  return static_cast<int>(rows);
}

/// row  frame - first frame of the scene
std::string frame_hash(const BakePlan& plan, int row) {
  std::string bytes;
  for (const Shot& shot : plan.shots) {
    for (const Handle& handle : shot.handles) {
      bytes += bytes_of_values(keyed_position(handle, row));
      bytes += handle.held(plan.animation.first_frame + row) ? 'h' : 'f';
    }
    // what hands press may depend on later keys
    for (const FoldingHands& hands : shot.hands)
      bytes += fmt::format("{}/", turn_at(hands.turn, row));
  }
  // the colliders of all sheets are those of the scene; they differ in where the paper stays
  const auto shot = std::find_if(plan.shots.begin(), plan.shots.end(),
                                 [](const Shot& s) { return s.colliders != nullptr; });
  if (shot != plan.shots.end())
    for (const Collider& collider : *shot->colliders)
      if (const auto& frames = collider.frames(); !frames.empty())
        bytes += bytes_of_values(frames[std::min<std::size_t>(row, frames.size() - 1)]);
  return hex(content_hash(bytes));
}

}  // namespace

std::string frame_input_hash(const std::string& before, const BakePlan& plan, int frame) {
  const int last = static_cast<int>(plan.frame_hash.size()) - 1;
  return hex(content_hash(
      before + plan.frame_hash[std::clamp(frame - plan.animation.first_frame, 0, last)]));
}

std::string scene_input_hash(const BakePlan& plan) {
  std::string hash = plan.simulation_hash;
  for (std::size_t row = 0; row < plan.frame_hash.size(); ++row)
    hash = frame_input_hash(hash, plan, plan.animation.first_frame + static_cast<int>(row));
  return hash;
}

void hash_frames(BakePlan& plan) {
  plan.frame_hash.clear();
  for (int row = 0; row < rows_of(plan); ++row) plan.frame_hash.push_back(frame_hash(plan, row));
}

void hash_inputs(BakePlan& plan) {
  std::string job, values = std::string(program_version) + "\n", of_simulation = values;
  for (const Wind& wind : plan.animation.elastic.air.winds) {
    values += fmt::format("wind/{}/{}/{}/", wind.name, wind.gust, wind.seed);
    values += bytes_of_values(wind.velocity);
  }
  of_simulation = values;
  // what is recorded of a frame says then how far its mesh puts it off
  if (plan.animation.checks_mesh) of_simulation += "checks its mesh\n";
  for (const UsedValue& value : plan.used) {
    const std::string line = value.key + " = " + value.value + "\n";
    if (value.key != "scene.file") values += line;
    if (!is_of_output(value.key)) of_simulation += line;
  }
  const auto hashes_with = [&](const std::string& settings) {
    std::vector<std::string> hashes;
    for (std::size_t s = 0; s < plan.shots.size(); ++s)
      hashes.push_back(
          hex(content_hash(start_bytes(plan.shots[s], plan.sheets[s].seed, settings))));
    return with_all(std::move(hashes));
  };
  const std::vector<std::string> start_hashes = hashes_with(values);
  plan.simulation_hash = hashes_with(of_simulation).front();
  hash_frames(plan);
  for (std::size_t s = 0; s < plan.sheets.size(); ++s) {
    std::string hash = start_hashes[s];
    plan.sheets[s].start_hash = hash;
    for (int f = plan.animation.first_frame; f <= plan.animation.last_frame; ++f)
      hash = frame_input_hash(hash, plan, f);
    job += hash;
  }
  for (const Shot& shot : plan.shots) job += authored_bytes(shot);
  plan.job_hash = hex(content_hash(job));
}

}  // namespace paperbake
