#include "formats/scene/scene_frames.h"

#include "core/model/degrees.h"
#include "core/model/error.h"
#include "formats/scene/scene_properties.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

namespace paperbake {
namespace {

constexpr double frame_rounding = 0.01;  // [frames] files store 99.9999 for 100
// [frames] more than an hour: beyond it the fps is wrong or the file is damaged
constexpr int max_clip_frames = 100000;
constexpr double max_positions = 2e7;  // nodes x frames: takes half a gigabyte and some seconds
constexpr double max_turn = 60;        // [degrees] between two keys

struct TimeRange {
  double first = 1e300, last = -1e300;
  void add(double t) {
    first = std::min(first, t);
    last = std::max(last, t);
  }
  bool empty() const { return first > last; }
};

/// Range of the keys. A track with a single key is not counted: it only says where the node is, and
/// importers put it at time 0.
TimeRange key_range(const std::vector<Motion>& motions,
                    const std::vector<std::vector<Track<Vector3d>>>& shapes) {
  TimeRange range;
  for (const Motion& motion : motions)
    if (motion.key_times.size() > 1) {
      range.add(motion.key_times.front());
      range.add(motion.key_times.back());
    }
  for (const auto& tracks : shapes)
    for (const Track<Vector3d>& track : tracks)
      if (track.keys.size() > 1) {
        range.add(track.keys.front().time);
        range.add(track.keys.back().time);
      }
  return range;
}

/// Converts times in the file to frames.
struct FrameClock {
  double fps;
  int shift = 0;  // [frames]
  double frame(double seconds) const {
    const double frame = seconds * fps + shift, whole = std::round(frame);
    return std::abs(frame - whole) <= frame_rounding ? whole : frame;
  }
};

bool all_keys_on_frames(const std::vector<Motion>& motions, double fps) {
  const FrameClock clock{fps};
  for (const Motion& motion : motions)
    if (motion.key_times.size() > 1)
      for (const double time : motion.key_times)
        if (const double frame = clock.frame(time); frame != std::round(frame)) return false;
  return true;
}

/// Frames per second by which the times in the file were computed: that of the scene, or for glTF
/// one that differs by a factor of 1.001, the ratio of video rates. Blender, for example, writes
/// frame / (30 x 1.001) for a scene of 29.97.
double clock_rate(SceneNodes& scene) {
  if (scene.file.fbx || all_keys_on_frames(scene.motions, scene.fps)) return scene.fps;
  for (const double off : {1.001 * 1.001, 1.001, 1 / 1.001}) {
    if (!all_keys_on_frames(scene.motions, scene.fps * off)) continue;
    scene.warnings.push_back(
        fmt::format("The file's times are those of {:.6g} frames per second: its keys are moved to "
                    "whole frames of {:.6g}.",
                    scene.fps * off, scene.fps));
    return scene.fps * off;
  }
  return scene.fps;
}

/// The frame at time 0 of the file.
int first_frame_shift(SceneNodes& scene, const SceneOptions& options, double first_key) {
  if (options.start_frame) {
    scene.origin["first_frame"] = "command line";
    return *options.start_frame -
           (scene.file.start_lost ? 0 : static_cast<int>(std::floor(first_key)));
  }
  scene.origin["first_frame"] = scene.file.start_lost ? "default" : "file";
  if (!scene.file.start_lost) return 0;
  scene.warnings.push_back(
      "The file does not say its first frame: 1 is assumed; --start-frame N sets it.");
  return 1;
}

/// The usual frame rate at which all keys lie on whole frames, if there is one.
std::optional<double> rate_of_keys(const std::vector<Motion>& motions) {
  for (const double rate : {24., 25., 30., 24 / 1.001, 30 / 1.001, 48., 50., 60., 60 / 1.001, 120.})
    if (all_keys_on_frames(motions, rate)) return rate;
  return std::nullopt;
}

void warn_of_keys_between_frames(SceneNodes& scene, const FrameClock& clock) {
  std::size_t between = 0, all = 0;
  for (const Motion& motion : scene.motions) {
    if (motion.key_times.size() < 2) continue;
    all += motion.key_times.size();
    for (const double time : motion.key_times)
      between += clock.frame(time) != std::round(clock.frame(time));
  }
  if (between == 0) return;
  std::string sentence =
      fmt::format("{} of {} keys lie between whole frames at {:.6g} frames per second: ", between,
                  all, scene.fps);
  if (const auto rate = rate_of_keys(scene.motions))
    sentence += fmt::format("at {:.5g} all lie on whole frames, so --fps {:.5g} is probably right.",
                            *rate, *rate);
  else
    sentence += "is that the frame rate of the scene (--fps)?";
  scene.warnings.push_back(std::move(sentence));
}

/// Converts the times of a track to frames, and its tangents accordingly.
template <class Value>
void convert_to_frames(Track<Value>& track, const FrameClock& clock) {
  for (Key<Value>& key : track.keys) key.time = clock.frame(key.time);
  for (Tangents<Value>& tangents : track.tangents)
    for (Value* tangent : {&tangents.in, &tangents.out}) {
      if constexpr (std::is_same_v<Value, Vector3d>)
        *tangent /= clock.fps;
      else
        tangent->coeffs() /= clock.fps;
    }
}

/// Range of the frames in which something moves; sampled tracks may go on beyond their keys.
TimeRange track_range(const std::vector<Motion>& motions) {
  TimeRange range;
  for (const Motion& motion : motions)
    for_each_track(motion, [&](const auto& track) {
      if (track.keys.size() > 1) {
        range.add(track.keys.front().time);
        range.add(track.keys.back().time);
      }
    });
  return range;
}

/// Warns of wide rotations between two keys: there the shorter arc of the file may differ from what
/// the DCC interpolates with Euler angles.
void warn_of_wide_turns(SceneNodes& scene) {
  double widest = max_turn;
  std::string where;
  for (std::size_t i = 0; i < scene.motions.size(); ++i) {
    const Track<Eigen::Quaterniond>& track = scene.motions[i].rotation;
    if (track.interpolation == Interpolation::step) continue;
    for (std::size_t k = 1; k < track.keys.size(); ++k) {
      const auto &a = track.keys[k - 1], &b = track.keys[k];
      const double turn = degrees_of(a.value.angularDistance(b.value));
      if (b.time - a.time <= 1 || turn <= widest) continue;
      widest = turn;
      where =
          fmt::format("\"{}\" turns by {:.0f} degrees between its keys at frames {:.6g} and {:.6g}",
                      scene.file.nodes[i].name, turn, a.time, b.time);
    }
  }
  if (!where.empty())
    scene.warnings.push_back(where +
                             ": the file does not say how the DCC interpolates between them; "
                             "export with a key on every frame.");
}

/// Sets the frames of a scene without keyed motion: those of the first take that has any, else 1.
void set_still_frames(SceneNodes& scene, const SceneOptions& options) {
  const FrameClock clock{scene.fps};
  int first = 1, last = 1;
  scene.origin["first_frame"] = options.start_frame ? "command line" : "default";
  for (const Take& take : scene.file.takes) {
    if (!(take.begin < take.end) || scene.file.start_lost ||
        !(std::abs(take.begin) + std::abs(take.end) < max_clip_frames / scene.fps))
      continue;
    first = static_cast<int>(std::floor(clock.frame(take.begin)));
    last = static_cast<int>(std::ceil(clock.frame(take.end)));
    if (!options.start_frame) scene.origin["first_frame"] = "file";
    break;
  }
  const int shift = options.start_frame ? *options.start_frame - first : 0;
  scene.first_frame = scene.last_frame = scene.first_clip_frame = first + shift;
  scene.last_clip_frame = last + shift;
}

}  // namespace

void set_fps(SceneNodes& scene, const SceneOptions& options) {
  const auto set = [&](double fps, std::string from) {
    scene.fps = fps;
    scene.origin["fps"] = std::move(from);
  };
  if (options.fps && !(*options.fps > 0 && std::isfinite(*options.fps)))
    throw Error(ErrorCode::scene, scene.source,
                fmt::format("{} frames per second cannot be right.", *options.fps),
                "Give a positive number to --fps.");
  if (options.fps) return set(*options.fps, "command line");
  if (scene.file.fps > 0) return set(scene.file.fps, "file");
  if (const auto fps = number_of_scene(
          scene.source, scene.file.nodes, "paper_fps",
          [&](const auto& node) { return positive_property(scene.source, node, "paper_fps"); }))
    return set(fps->value, fmt::format("paper_fps of \"{}\"", fps->node));
  set(24, "default");
  scene.warnings.push_back(
      "The file does not say its frame rate: 24 frames per second are assumed; "
      "--fps N or a property paper_fps sets it.");
}

void set_frames(SceneNodes& scene, const SceneOptions& options,
                const std::vector<const Take*>& used) {
  const TimeRange keys = key_range(scene.motions, scene.shapes);
  if (keys.empty()) return set_still_frames(scene, options);
  FrameClock clock{clock_rate(scene)};
  clock.shift = std::abs(keys.first) * scene.fps < 1e9
                    ? first_frame_shift(scene, options, clock.frame(keys.first))
                    : 0;
  TimeRange clip = keys;
  for (const Take* take : used)
    if (take->begin < take->end) {
      clip.add(take->begin);
      clip.add(take->end);
    }
  const double first = clock.frame(clip.first), last = clock.frame(clip.last);
  if (!(last - first <= max_clip_frames) || std::abs(first) > 1e9)
    throw Error(ErrorCode::scene, scene.source,
                fmt::format("The clip runs from frame {:.6g} to {:.6g}.", first, last),
                "Check --fps, and the range of the export.");
  if ((last - first + 1) * scene.file.nodes.size() > max_positions)
    throw Error(ErrorCode::scene, scene.source,
                fmt::format("The clip has {:.6g} frames of {} nodes, which is too much.",
                            last - first + 1, scene.file.nodes.size()),
                "Export only the sheets and handles, or a shorter range.");
  for (Motion& motion : scene.motions)
    for_each_track(motion, [&](auto& track) { convert_to_frames(track, clock); });
  for (auto& tracks : scene.shapes)
    for (Track<Vector3d>& track : tracks) convert_to_frames(track, clock);
  scene.first_clip_frame = static_cast<int>(std::floor(first));
  scene.last_clip_frame = static_cast<int>(std::ceil(last));
  scene.first_frame = static_cast<int>(std::floor(clock.frame(keys.first)));
  scene.last_frame = static_cast<int>(std::ceil(clock.frame(keys.last)));
  // curves that go on beyond their keys do so over the whole clip
  const TimeRange moving = track_range(scene.motions);
  if (moving.first < scene.first_frame) scene.first_frame = scene.first_clip_frame;
  if (moving.last > scene.last_frame) scene.last_frame = scene.last_clip_frame;
  warn_of_keys_between_frames(scene, clock);
  warn_of_wide_turns(scene);
}

}  // namespace paperbake
