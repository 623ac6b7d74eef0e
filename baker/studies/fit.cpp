#include "baker/studies/fit.h"

#include "core/geometry/random.h"
#include "core/model/error.h"
#include "formats/files/atomic_file.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

namespace paperbake {
namespace {

constexpr int min_points = 3;
constexpr double tail = 0.025;
constexpr int splits = 999;

std::string_view trimmed(std::string_view word) {
  while (!word.empty() && (word.front() == ' ' || word.front() == '\t' || word.front() == '"'))
    word.remove_prefix(1);
  while (!word.empty() &&
         (word.back() == ' ' || word.back() == '\t' || word.back() == '\r' || word.back() == '"'))
    word.remove_suffix(1);
  return word;
}

std::vector<std::string_view> fields(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t comma = std::min(line.find(',', from), line.size());
    words.push_back(trimmed(line.substr(from, comma - from)));
    from = comma + 1;
  }
  return words;
}

double mean_distance(const std::vector<Vector2d>& points, const std::vector<int>& of_a, int side_a,
                     int side_b) {
  double sum = 0;
  long pairs = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = 0; j < points.size(); ++j)
      if (of_a[i] == side_a && of_a[j] == side_b) {
        sum += (points[i] - points[j]).norm();
        ++pairs;
      }
  return sum / pairs;
}

double energy_distance(const std::vector<Vector2d>& points, const std::vector<int>& of_a) {
  return 2 * mean_distance(points, of_a, 1, 0) - mean_distance(points, of_a, 1, 1) -
         mean_distance(points, of_a, 0, 0);
}

}  // namespace

std::vector<Vector2d> read_scatter(const std::filesystem::path& path) {
  const std::optional<std::string> bytes = read_file(path);
  std::istringstream file(bytes.value_or(""));
  const auto fail = [&](int line, const std::string& cause, const std::string& remedy = "") {
    throw Error(ErrorCode::command,
                line ? fmt::format("{}:{}", path.string(), line) : path.string(), cause, remedy);
  };
  if (!bytes)
    fail(0, "The file of points cannot be read.",
         "Name a .csv file with columns u and v, in metres.");
  std::string text;
  if (!std::getline(file, text))
    fail(1, "The file is empty.", "Its first line names the columns: u,v.");
  const std::vector<std::string_view> names = fields(text);
  const auto column = [&](const char* name) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end())
      fail(1, fmt::format("There is no column \"{}\".", name),
           "The first line names the columns: u,v.");
    return at - names.begin();
  };
  const auto columns = {column("u"), column("v")};
  std::vector<Vector2d> points;
  for (int line = 2; std::getline(file, text); ++line) {
    if (trimmed(text).empty()) continue;
    const std::vector<std::string_view> words = fields(text);
    Vector2d p;
    int k = 0;
    for (const auto c : columns) {
      if (c >= static_cast<long>(words.size()))
        fail(line, fmt::format("The line has {} columns, not {}.", words.size(), names.size()));
      const std::string_view word = words[c];
      const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), p[k]);
      if (failed != std::errc() || end != word.data() + word.size())
        fail(line, fmt::format("\"{}\" is no number.", word));
      if (!(p[k] >= 0 && p[k] <= experiment_side))
        fail(line, fmt::format("{} m lies beside the sheet of 100 x 100 mm.", p[k]),
             "Give u and v in metres, from the corner of the sheet; the pushed border is v = 0.");
      ++k;
    }
    points.push_back(p);
  }
  if (static_cast<int>(points.size()) < min_points)
    fail(0, fmt::format("{} points say nothing of a scatter.", points.size()),
         fmt::format("Measure at least {} sheets; 20 give the deviation within 30 %.", min_points));
  return points;
}

ScatterFit fit_scatter(const std::vector<Vector2d>& points, const Vector2d& mean_of_law) {
  const int n = static_cast<int>(points.size()), freedom = 2 * n - 2;
  Vector2d mean = Vector2d::Zero();
  for (const Vector2d& p : points) mean += p / n;
  double squares = 0;
  for (const Vector2d& p : points) squares += (p - mean).squaredNorm();
  ScatterFit fit;
  fit.points = n;
  fit.offset = mean - mean_of_law;
  fit.likeliest = std::sqrt(squares / (2 * n));
  fit.deviation = std::sqrt(squares / freedom);
  const double reach =
      quantile(complement(boost::math::students_t(freedom), tail)) * fit.deviation / std::sqrt(n);
  fit.offset_u = {fit.offset.x() - reach, fit.offset.x() + reach};
  fit.offset_v = {fit.offset.y() - reach, fit.offset.y() + reach};
  const boost::math::chi_squared law(freedom);
  fit.deviation_within = {std::sqrt(squares / quantile(complement(law, tail))),
                          std::sqrt(squares / quantile(law, tail))};
  return fit;
}

TwoSamples compare_samples(const std::vector<Vector2d>& a, const std::vector<Vector2d>& b) {
  std::vector<Vector2d> points = a;
  points.insert(points.end(), b.begin(), b.end());
  std::vector<int> of_a(points.size(), 0);
  std::fill(of_a.begin(), of_a.begin() + a.size(), 1);
  const double energy = energy_distance(points, of_a);
  int farther = 1;
  std::uint64_t draw = 0;
  for (int split = 0; split < splits; ++split) {
    for (std::size_t k = of_a.size() - 1; k > 0; --k)
      std::swap(of_a[k], of_a[scramble(++draw) % (k + 1)]);
    farther += energy_distance(points, of_a) >= energy;
  }
  return {energy, farther / (splits + 1.0)};
}

Preset with_scatter(Preset grade, const std::string& name, const ScatterFit& fit,
                    const std::string& measured) {
  const double rounded = std::round(fit.deviation * 1e6) * 1e-6;
  grade.paper.name = name;
  grade.paper.apex_scatter = rounded;
  for (Preset::Entry& entry : grade.entries)
    if (entry.key == "apex_scatter") {
      entry.value = rounded;
      entry.source = fmt::format(
          "fitted to the first singular points of {} sheets ({}): {:.2f} mm, in [{:.2f}, {:.2f}] "
          "mm with 95 %; mean off by ({:.1f}, {:.1f}) mm from the law's",
          fit.points, measured, 1e3 * fit.deviation, 1e3 * fit.deviation_within.low,
          1e3 * fit.deviation_within.high, 1e3 * fit.offset.x(), 1e3 * fit.offset.y());
      entry.mark = "derived";
    }
  return grade;
}

Image fit_picture(const Preset& grade, const std::vector<Vector2d>& measured,
                  const std::vector<Vector2d>& simulated, const ScatterFit& fit) {
  ScatterPicture shown;
  shown.title = fmt::format("{}: x {} sheets measured, o {} simulated", grade.paper.name,
                            measured.size(), simulated.size());
  shown.caption = fmt::format("off by ({:.1f}, {:.1f}) mm, deviation {:.2f} mm [{:.2f}, {:.2f}]",
                              1e3 * fit.offset.x(), 1e3 * fit.offset.y(), 1e3 * fit.deviation,
                              1e3 * fit.deviation_within.low, 1e3 * fit.deviation_within.high);
  shown.crosses = measured;
  shown.dots = simulated;
  for (const Vector2d& p : measured) shown.mean += p / measured.size();
  shown.deviation = fit.deviation;
  return draw_scatter(shown);
}

}  // namespace paperbake
