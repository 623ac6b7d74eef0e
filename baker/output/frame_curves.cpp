#include "baker/output/frame_curves.h"
#include "formats/files/frame_statistics_table.h"

#include <map>
#include <type_traits>

namespace paperbake {

std::vector<FrameChart> frame_charts() {
  std::map<int, FrameChart> by_number;
  visit_frame_statistics([&](const auto& field) {
    if (!field.curve.label) return;
    FrameChart& chart = by_number[field.curve.chart];
    chart.unit = field.unit.symbol;
    chart.stepped = std::is_integral_v<typename std::decay_t<decltype(field)>::Value>;
    chart.lines.push_back(
        {field.curve.label,
         [field](const FrameRecord& r) { return statistic_value(r.statistics, field).value_or(0); },
         field.curve.over_sheets == ReportCurve::sum});
  });
  std::vector<FrameChart> charts;
  for (auto& [number, chart] : by_number) charts.push_back(std::move(chart));
  return charts;
}

}  // namespace paperbake
