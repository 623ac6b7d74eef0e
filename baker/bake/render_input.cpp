#include "baker/bake/render_input.h"

#include <algorithm>

namespace paperbake {

std::size_t sheets_with_frame(const std::vector<RenderInput>& sheets, std::size_t k) {
  std::size_t count = 0;
  while (count < sheets.size() && k < sheets[count].record->frames().size()) ++count;
  return count;
}

bool simulated_alike(const std::vector<RenderInput>& sheets, std::size_t k) {
  if (k == 0 || sheets_with_frame(sheets, k) != sheets_with_frame(sheets, k - 1)) return false;
  for (std::size_t s = 0; s < sheets_with_frame(sheets, k); ++s) {
    const RecordedFrame &now = sheets[s].record->frames()[k],
                        &before = sheets[s].record->frames()[k - 1];
    if (now.mesh != before.mesh || now.x != before.x) return false;
  }
  return true;
}

std::size_t frames_of_any(const std::vector<RenderInput>& sheets) {
  std::size_t count = 0;
  for (const RenderInput& sheet : sheets) count = std::max(count, sheet.record->frames().size());
  return count;
}

std::vector<std::vector<std::size_t>> groups_near_each_other(
    const std::vector<const ShotRecord*>& records) {
  std::vector<std::vector<Eigen::AlignedBox3f>> boxes(records.size());
  for (std::size_t s = 0; s < records.size(); ++s)
    for (const RecordedFrame& frame : records[s]->frames()) {
      // the curved surface stands out from its flat triangles by less than half an edge
      const Eigen::Vector3f margin =
          Eigen::Vector3f::Constant(static_cast<float>(0.5 * records[s]->edge()));
      boxes[s].emplace_back(frame.x.colwise().minCoeff().transpose() - margin,
                            frame.x.colwise().maxCoeff().transpose() + margin);
    }
  const auto near = [&](std::size_t s, std::size_t t) {
    for (std::size_t k = 0; k < std::min(boxes[s].size(), boxes[t].size()); ++k)
      if (boxes[s][k].intersects(boxes[t][k])) return true;
    return false;
  };
  std::vector<std::size_t> group(records.size());  // named after its first sheet
  for (std::size_t s = 0; s < records.size(); ++s) {
    group[s] = s;
    for (std::size_t t = 0; t < s; ++t)
      if (const std::size_t a = std::min(group[s], group[t]), b = std::max(group[s], group[t]);
          a != b && near(s, t))
        std::replace(group.begin(), group.begin() + static_cast<std::ptrdiff_t>(s) + 1, b, a);
  }
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t first = 0; first < records.size(); ++first) {
    std::vector<std::size_t> sheets;
    for (std::size_t s = 0; s < records.size(); ++s)
      if (group[s] == first) sheets.push_back(s);
    if (!sheets.empty()) groups.push_back(sheets);
  }
  return groups;
}

}  // namespace paperbake
