#include "baker/output/report.h"

#include "baker/job/version.h"
#include "baker/output/frame_curves.h"
#include "baker/output/report_parts.h"
#include "core/geometry/collider_motion.h"
#include "formats/files/bytes_of.h"
#include "formats/files/json.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {
namespace {

std::string base64(std::string_view bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return k < bytes.size() ? std::uint32_t(static_cast<unsigned char>(bytes[k])) : 0u;
    };
    const std::uint32_t three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (int k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? digits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

template <class Values>
std::string base64_of(const Values& values) {
  return base64(bytes_of_values(values));
}

void replace(std::string& page, std::string_view mark, std::string_view text) {
  page.replace(page.find(mark), mark.size(), text);
}

/// How much a sheet is folded: over its inner edges, length times dihedral angle. [m rad]
double folding(const Points3& x, const Hinges& hinges) {
  double sum = 0;
  for (const Hinge& hinge : hinges.hinges)
    sum += (x.row(hinge.vertices[1]) - x.row(hinge.vertices[0])).norm() *
           std::abs(dihedral_angle(x, hinge));
  return sum;
}

/// Curves over time, one point a frame; of several sheets the sum or the worst.
Json curves_json(const std::vector<FrameRecord>& records) {
  Json curves = Json::array();
  for (const FrameChart& curve : frame_charts()) {
    Json lines = Json::array();
    for (const FrameLine& line : curve.lines) {
      std::map<int, double> by_frame;
      for (const FrameRecord& r : records) {
        double& value = by_frame[r.frame];
        value = line.sum ? value + line.value(r) : std::max(value, line.value(r));
      }
      Json values = Json::array();
      for (const auto& [frame, value] : by_frame) values.push_back(value);
      lines.push_back({{"name", line.name}, {"values", values}});
    }
    curves.push_back({{"unit", curve.unit}, {"stepped", curve.stepped}, {"lines", lines}});
  }
  return curves;
}

/// Positions in 16 bits between the corners of the box that the sheet moves in.
template <class Sheet>
Json sheet_json(const Sheet& sheet) {
  Eigen::RowVector3f low = sheet.frames.front().x.colwise().minCoeff(), high = low;
  for (const auto& frame : sheet.frames) {
    low = low.cwiseMin(frame.x.colwise().minCoeff());
    high = high.cwiseMax(frame.x.colwise().maxCoeff());
  }
  Json meshes = Json::array(), shown = Json::array();
  for (const Triangles& triangles : sheet.meshes)
    meshes.push_back(base64_of(Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor>(
        triangles.cast<std::uint32_t>())));
  const Eigen::RowVector3f span = (high - low).cwiseMax(1e-9f);
  for (const auto& frame : sheet.frames) {
    const auto share = ((frame.x.rowwise() - low).array().rowwise() / span.array() * 65535.0f)
                           .round()
                           .matrix()
                           .eval();
    shown.push_back(
        {{"mesh", frame.mesh},
         {"x", base64_of(Eigen::Matrix<std::uint16_t, Eigen::Dynamic, 3, Eigen::RowMajor>(
                   share.template cast<std::uint16_t>()))}});
  }
  return {{"low", {low.x(), low.y(), low.z()}},
          {"high", {low.x() + span.x(), low.y() + span.y(), low.z() + span.z()}},
          {"meshes", meshes},
          {"frames", shown}};
}

/// Of every frame x, y, z [m] and 1 where the paper does not follow, else 0, of each handle that
/// holds the sheet: where it is keyed.
Json handles_json(const std::vector<HandleRecord>& handles, const std::vector<int>& frames) {
  std::map<int, Json> by_frame;
  for (const HandleRecord& handle : handles) {
    if (handle.state == HandleFrame::free) continue;
    Json& all = by_frame[handle.frame];
    for (int axis = 0; axis < 3; ++axis) all.push_back(std::round(1e5 * handle.keyed[axis]) / 1e5);
    all.push_back(handle.state == HandleFrame::jammed ? 1 : 0);
  }
  Json of_frames = Json::array();
  for (const int frame : frames) {
    const auto found = by_frame.find(frame);
    of_frames.push_back(found == by_frame.end() ? Json::array() : found->second);
  }
  return of_frames;
}

/// Triangles and positions of each collider, in every frame or, where it stands still, once. Of
/// large ones that move only every n-th frame is kept, so that the page stays below 12 MB.
Json colliders_json(const Colliders& colliders, const std::vector<int>& frames, int first_frame) {
  constexpr double max_bytes = 3e6;
  const ColliderShapes begin = shapes_at(colliders, frames.front() - first_frame);
  std::vector<char> moves(begin.size(), 0);
  for (const int frame : frames) {
    const ColliderShapes shapes = shapes_at(colliders, frame - first_frame);
    for (std::size_t c = 0; c < shapes.size(); ++c)
      moves[c] |= shapes[c]->mesh().x != begin[c]->mesh().x;
  }
  double bytes = 0;
  for (std::size_t c = 0; c < begin.size(); ++c)
    if (moves[c])
      bytes += 12.0 * static_cast<double>(begin[c]->mesh().x.rows()) *
               static_cast<double>(frames.size());
  const auto stride = static_cast<std::size_t>(std::max(1.0, std::ceil(bytes / max_bytes)));
  Json all = Json::array();
  for (const auto& shape : begin)
    all.push_back(
        {{"faces", base64_of(Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor>(
                       shape->mesh().triangles.cast<std::uint32_t>()))},
         {"x", Json::array()}});
  for (std::size_t k = 0; k < frames.size(); k += stride) {
    const ColliderShapes shapes = shapes_at(colliders, frames[k] - first_frame);
    for (std::size_t c = 0; c < shapes.size(); ++c)
      if (k == 0 || moves[c])
        all[c]["x"].push_back(base64_of(Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>(
            shapes[c]->mesh().x.cast<float>())));
  }
  return {{"stride", stride}, {"all", all}};
}

/// Each missed gate with what to do about it, and what failed.
Json missed_json(const BakeEnding& ending) {
  Json all = Json::array();
  for (const MissedGate& missed : ending.missed)
    all.push_back({{"sentence", missed.sentence}, {"advice", missed.advice}});
  if (!ending.failure.empty()) all.push_back({{"sentence", ending.failure}, {"advice", ""}});
  return all;
}

}  // namespace

Report::Report(const BakePlan& plan, std::size_t frames)
    : plan_(plan), frames_(frames), sheets_(plan.shots.size()) {}

void Report::add_frame(std::size_t number, const CacheFrame& frame) {
  constexpr double max_bytes = 8e6;  // of positions, before base64 makes a third more of them
  ShownSheet& sheet = sheets_.at(number);
  if (number == 0 && sheet.given == 0) {
    const double all = 6.0 * frame.x.rows() * frames_ * sheets_.size();
    stride_ = static_cast<std::size_t>(std::max(1.0, std::ceil(all / max_bytes)));
  }
  if (sheet.given++ % stride_ != 0) return;
  if (sheet.meshes.empty() || sheet.meshes.back().rows() != frame.triangles.rows() ||
      sheet.meshes.back() != frame.triangles) {
    sheet.meshes.push_back(frame.triangles);
    sheet.hinges = find_hinges(frame.triangles);
  }
  sheet.frames.push_back(
      {sheet.meshes.size() - 1, frame.x.cast<float>(), folding(frame.x, sheet.hinges)});
}

std::size_t Report::most_folded() const {
  std::vector<double> folded;
  for (const ShownSheet& sheet : sheets_) {
    folded.resize(std::max(folded.size(), sheet.frames.size()));
    for (std::size_t k = 0; k < sheet.frames.size(); ++k) folded[k] += sheet.frames[k].folding;
  }
  return stride_ * (std::max_element(folded.begin(), folded.end()) - folded.begin());
}

void Report::add_map(const std::string& caption, const std::string& png) {
  maps_.push_back({caption, png});
}

std::string Report::html(const BakeEnding& ending) const {
  const std::vector<FrameRecord>& records = ending.frames;
  Json data{{"name", plan_.name},
            {"missed", missed_json(ending)},
            {"good", good_news(records, ending.missed)},
            {"stride", stride_},
            {"seconds_a_frame", plan_.frames.step / plan_.animation.fps}};
  std::vector<int> frames;
  for (const FrameRecord& r : records)
    if (frames.empty() || frames.back() != r.frame) frames.push_back(r.frame);
  data["frames"] = frames;
  data["begin"] = most_folded();
  data["what"] = frames.empty() ? ""
                                : fmt::format("{}, frames {}-{} at {:g} fps, paperbake {}",
                                              plan_.method, frames.front(), frames.back(),
                                              plan_.animation.fps, program_version);
  data["settings"] = Json::array();
  for (const UsedValue& value : plan_.used)
    data["settings"].push_back({value.key, value.value, value.origin});

  data["curves"] = curves_json(records);
  data["sheets"] = Json::array();
  for (const ShownSheet& sheet : sheets_)
    if (!sheet.frames.empty()) data["sheets"].push_back(sheet_json(sheet));
  data["handles"] = handles_json(handles_, frames);
  if (const auto& colliders = plan_.shots.front().colliders; colliders && !frames.empty())
    data["colliders"] = colliders_json(*colliders, frames, plan_.animation.first_frame);
  data["maps"] = Json::array();
  for (const Picture& picture : maps_)
    data["maps"].push_back({{"caption", picture.caption}, {"png", base64(picture.png)}});

  std::string json = json_line(data);
  // no name may end the script, or begin a comment in it that swallows its end
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos; at += 6)
    json.replace(at, 1, "\\u003c");
  std::string page = paperbake_report_page;
  // from the end, so that no mark inside a part is taken for one
  replace(page, "@CHART@", paperbake_report_chart);
  replace(page, "@ORBIT@", paperbake_report_orbit);
  replace(page, "@THREE@", paperbake_report_three);
  replace(page, "@DATA@", json);
  return page;
}

}  // namespace paperbake
