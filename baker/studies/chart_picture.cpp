#include "baker/studies/chart_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <utility>

namespace paperbake {
namespace {

constexpr double width = 1280, height = 760, panel_top = 92, panel_height = 500;
constexpr const char* font = "font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\"";

const char* colour_of(const std::string& method) {
  static const std::map<std::string, const char*> colours{{"hybrid", "#c8401c"},
                                                          {"fem", "#2a62a8"},
                                                          {"adaptive", "#3b8a3e"},
                                                          {"hybrid+fem", "#8a3fa0"},
                                                          {"fem-loose", "#6fa8dc"}};
  const auto found = colours.find(method);
  return found == colours.end() ? "#555555" : found->second;
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else
      safe += c >= 0 && c < ' ' ? ' ' : c;  // control characters are not XML
  }
  return safe;
}

std::string text(double x, double y, double size, const std::string& words,
                 const char* anchor = "start", const char* fill = "#222222",
                 const char* more = "") {
  return fmt::format(
      "<text x=\"{:.1f}\" y=\"{:.1f}\" {} font-size=\"{:.1f}\" text-anchor=\"{}\" "
      "fill=\"{}\"{}>{}</text>\n",
      x, y, font, size, anchor, fill, more, escaped(words));
}

/// A logarithmic axis from pixel a to pixel b.
class LogAxis {
 public:
  LogAxis(std::vector<double> values, double a, double b) : a_(a), b_(b) {
    values.erase(std::remove_if(values.begin(), values.end(),
                                [](double v) { return !(v > 0) || !std::isfinite(v); }),
                 values.end());
    const double low = values.empty() ? 1 : *std::min_element(values.begin(), values.end());
    const double high = values.empty() ? 10 : *std::max_element(values.begin(), values.end());
    const double room = std::max(0.08 * std::log10(high / low), 0.12);
    // room for the last label
    low_ = std::log10(low) - room;
    high_ = std::log10(high) + 1.6 * room;
  }
  double operator()(double value) const {
    return a_ + (b_ - a_) * (std::log10(std::max(value, 1e-300)) - low_) / (high_ - low_);
  }
  /// 1, 2, 5 of every decade, or the decades alone where there are many.
  std::vector<double> ticks() const {
    std::vector<double> at;
    const std::vector<double> steps =
        high_ - low_ > 3 ? std::vector<double>{1} : std::vector<double>{1, 2, 5};
    for (int decade = static_cast<int>(std::floor(low_)); decade <= high_; ++decade)
      for (const double step : steps)
        if (const double l = decade + std::log10(step); l >= low_ && l <= high_)
          at.push_back(step * std::pow(10, decade));
    return at;
  }

 private:
  double a_, b_, low_, high_;
};

struct PlotPanel {
  std::string title, unit;
  std::function<double(const ChartPoint&)> value;
  std::vector<std::pair<double, std::string>> lines;  // across: value and what it is
  std::vector<int> front;
};

/// Boxes of labels that are placed already.
class Labels {
 public:
  /// The first free place about a point, right, above, left or below it; none: no label.
  std::string place(double x, double y, const std::string& words, const char* colour) {
    constexpr double size = 12, letter = 6.9;
    const double w = letter * words.size();
    const std::array<std::array<double, 2>, 6> offsets{
        {{9, 4}, {-w / 2, -10}, {-w - 9, 4}, {-w / 2, 19}, {9, -9}, {9, 17}}};
    for (const auto& o : offsets) {
      const std::array<double, 4> box{x + o[0], y + o[1] - size, x + o[0] + w, y + o[1] + 3};
      if (std::any_of(taken_.begin(), taken_.end(), [&](const auto& t) {
            return box[0] < t[2] && t[0] < box[2] && box[1] < t[3] && t[1] < box[3];
          }))
        continue;
      taken_.push_back(box);
      return text(x + o[0], y + o[1], size, words, "start", colour);
    }
    return "";
  }
  void keep_free(double x, double y, double radius) {
    taken_.push_back({x - radius, y - radius, x + radius, y + radius});
  }

 private:
  std::vector<std::array<double, 4>> taken_;
};

/// Lines at the ticks of both axes, and their numbers.
std::string draw_grid(const LogAxis& x, const LogAxis& y, double left, double right) {
  const double bottom = panel_top + panel_height;
  std::string svg;
  for (const double t : x.ticks()) {
    svg += fmt::format(
        "<line x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\" stroke=\"#e4e4e4\"/>\n", x(t),
        panel_top, bottom);
    svg += text(x(t), bottom + 17, 12, fmt::format("{:g}", t), "middle");
  }
  for (const double t : y.ticks()) {
    svg += fmt::format(
        "<line x1=\"{1}\" y1=\"{0:.1f}\" x2=\"{2}\" y2=\"{0:.1f}\" stroke=\"#e4e4e4\"/>\n", y(t),
        left, right);
    svg += text(left - 6, y(t) + 4, 12, fmt::format("{:g}", t), "end");
  }
  return svg;
}

/// The band along the points that no other one beats.
std::string draw_front(const PlotPanel& panel, const std::vector<ChartPoint>& points,
                       const LogAxis& x, const LogAxis& y) {
  if (panel.front.size() < 2) return "";
  std::string path;
  for (std::size_t k = 0; k < panel.front.size(); ++k) {
    const ChartPoint& p = points[panel.front[k]];
    path += fmt::format("{}{:.1f} {:.1f} ", k == 0 ? "M" : "L", x(p.total_ms()), y(panel.value(p)));
  }
  return fmt::format(
      "<path d=\"{}\" fill=\"none\" stroke=\"#bbbbbb\" stroke-width=\"7\" "
      "stroke-linejoin=\"round\" stroke-opacity=\"0.6\"/>\n",
      path);
}

/// A disc; for a run that failed, a ring with a cross beside it.
std::string draw_mark(double a, double b, const char* colour, bool failed) {
  if (!failed)
    return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4.5\" fill=\"{}\"/>\n", a, b,
                       colour);
  return fmt::format(
             "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5.5\" fill=\"#ffffff\" stroke=\"{}\" "
             "stroke-width=\"1.5\"/>\n",
             a, b, colour) +
         fmt::format(
             "<path d=\"M{:.1f} {:.1f} l8 8 m0 -8 l-8 8\" stroke=\"{}\" stroke-width=\"1.5\"/>\n",
             a - 4, b - 4, colour);
}

std::string draw(const PlotPanel& panel, const std::vector<ChartPoint>& points, double left,
                 double panel_width) {
  std::vector<double> xs, ys;
  for (const ChartPoint& p : points)
    if (panel.value(p) > 0) {
      xs.push_back(p.total_ms());
      ys.push_back(panel.value(p));
    }
  for (const auto& [value, what] : panel.lines) ys.push_back(value);
  const double bottom = panel_top + panel_height, right = left + panel_width;
  const LogAxis x(xs, left, right), y(ys, bottom, panel_top);
  std::string svg = fmt::format(
      "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"#ffffff\" stroke=\"#888888\"/>\n",
      left, panel_top, panel_width, panel_height);
  svg += text(left, panel_top - 12, 15, panel.title, "start", "#222222", " font-weight=\"bold\"");
  svg += draw_grid(x, y, left, right);
  svg += text(left + panel_width / 2, bottom + 38, 13,
              "CPU time of a frame, elastic + geometry [ms]", "middle");
  svg += text(left + 8, panel_top + 18, 12, panel.unit, "start", "#555555");
  Labels labels;
  for (const auto& [value, what] : panel.lines) {
    svg += fmt::format(
        "<line x1=\"{1}\" y1=\"{0:.1f}\" x2=\"{2}\" y2=\"{0:.1f}\" stroke=\"#777777\" "
        "stroke-dasharray=\"6 4\"/>\n",
        y(value), left, right);
    svg += text(right - 6, y(value) - 5, 11.5, what, "end", "#555555");
  }
  svg += draw_front(panel, points, x, y);
  std::map<std::pair<std::string, int>, std::vector<const ChartPoint*>> sizes;  // seeds of one size
  for (const ChartPoint& p : points)
    if (panel.value(p) > 0) {
      sizes[{p.method, p.size}].push_back(&p);
      labels.keep_free(x(p.total_ms()), y(panel.value(p)), 5);
    }
  for (const auto& [size, seeds] : sizes) {
    const char* colour = colour_of(size.first);
    double px = 0, low = 1e300, high = 0;
    for (const ChartPoint* p : seeds) {
      px += x(p->total_ms()) / seeds.size();
      low = std::min(low, panel.value(*p));
      high = std::max(high, panel.value(*p));
    }
    if (seeds.size() > 1)
      svg += fmt::format(
          "<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\" stroke=\"{3}\" "
          "stroke-width=\"2\"/>\n",
          px, y(low), y(high), colour);
    for (const ChartPoint* p : seeds)
      svg += draw_mark(x(p->total_ms()), y(panel.value(*p)), colour, !p->failure.empty());
    const ChartPoint& lead = *seeds[seeds.size() / 2];
    svg += labels.place(x(lead.total_ms()), y(panel.value(lead)),
                        fmt::format("{}{}", size.second, lead.failure.empty() ? "" : " unfinished"),
                        colour);
  }
  return svg;
}

}  // namespace

std::string chart_svg(const Chart& chart) {
  const auto c_m = [](const ChartPoint& p) { return p.c_m_pct; };
  PlotPanel distance{"Distance to the reference",
                     "RMS over 41 x 41 points, % of the longer side",
                     [](const ChartPoint& p) { return p.rms_pct; },
                     {},
                     pareto_front(chart.points)};
  if (chart.reference_error_pct > 0)
    distance.lines.push_back(
        {chart.reference_error_pct,
         fmt::format("error of the reference itself: {:.2g} %", chart.reference_error_pct)});
  if (chart.control_pct > 0)
    distance.lines.push_back(
        {chart.control_pct, fmt::format("reference on another mesh: {:.2g} %", chart.control_pct)});
  const PlotPanel energy{"Stored energy over the reference's (chaotic scene)",
                         "mean over the frames",
                         [](const ChartPoint& p) { return p.energy_rel; },
                         {{1.0, "the reference"}},
                         {}};
  const PlotPanel lengths{
      "Length error c_m", "mean |l - L|/L over edges and frames, %", c_m, {}, {}};

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
      "{1}\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"#f7f7f4\"/>\n",
      width, height);
  svg += text(70, 34, 19, "Speed against accuracy: " + chart.scene, "start", "#111111",
              " font-weight=\"bold\"");
  double at = 70;
  std::vector<std::string> methods;
  for (const ChartPoint& p : chart.points)
    if (std::find(methods.begin(), methods.end(), p.method) == methods.end())
      methods.push_back(p.method);
  for (const std::string& method : methods) {
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"54\" r=\"5\" fill=\"{}\"/>\n", at + 5,
                       colour_of(method));
    svg += text(at + 15, 58.5, 13, method);
    at += 40 + 8.0 * method.size();
  }
  svg += draw(chart.chaotic ? energy : distance, chart.points, 70, 540);
  svg += draw(lengths, chart.points, 705, 540);
  double line = panel_top + panel_height + 66;
  const ChartPoint& reference = chart.points.front();
  svg += text(70, line, 12.5,
              fmt::format("Reference: fem, {:.0f} triangles, {:.0f} ms a frame. Means over frames, "
                          "medians over repeats, one thread. {}",
                          reference.triangles, reference.total_ms(), chart.machine),
              "start", "#444444");
  svg += text(
      70, line += 19, 12.5,
      "Numbers: triangles of fem (fem-loose: ten times the stop; hybrid+fem: of the polish), base "
      "triangles of hybrid, the most adaptive may have; bars: seeds; broad line: Pareto front.",
      "start", "#444444");
  for (const std::string& remark : chart.remarks)
    svg += text(70, line += 19, 12.5, remark, "start", "#444444");
  return svg + "</svg>\n";
}

}  // namespace paperbake
