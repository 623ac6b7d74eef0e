#include "core/animation/animate.h"
#include "core/geometry/crease_network.h"
#include "core/methods/hybrid.h"
#include "formats/scene/scene_file.h"
#include "tests/validation/cases.h"

#include <algorithm>

// A single crumple has no statistics: counts are means over seeds, lengths are of all seeds
// together.

namespace paperbake::validation {
namespace {

struct Crumpled {
  double births = 0;
  // by frame: extent over that of the first frame; [m] length of all creases
  std::vector<double> compaction, length;
  std::vector<double> creases;  // [m] of the last frame
};

Crumpled run(const Scene& scene, unsigned seed) {
  const SceneSheet& s = scene.sheets.front();
  const Shot shot{s.name, s.pattern, s.start, s.handles, Paper{}};
  AnimateOptions options;
  options.fps = scene.fps;
  options.last_frame = scene.last_frame;
  options.seed = seed;
  options.plasticity = Plasticity::on;
  Crumpled c;
  animate(shot, hybrid(shot.pattern, shot.paper, 120, {}, seed, 0), options,
          [&](const AnimatedFrame& frame) {
            const Sheet& sheet = *frame.sheet;
            const Points3 about = sheet.x.rowwise() - sheet.x.colwise().mean();
            const Points2 flat = sheet.pattern.rowwise() - sheet.pattern.colwise().mean();
            c.compaction.push_back(about.rowwise().norm().maxCoeff() /
                                   flat.rowwise().norm().maxCoeff());
            CreaseNetwork network = crease_network(sheet);
            c.length.push_back(network.length);
            c.births = static_cast<double>(sheet.singular.size());
            c.creases = std::move(network.creases);
            return true;
          });
  return c;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  double n = 0, sa = 0, sb = 0, aa = 0, bb = 0, ab = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    n += 1;
    sa += a[i];
    sb += b[i];
    aa += a[i] * a[i];
    bb += b[i] * b[i];
    ab += a[i] * b[i];
  }
  return (n * ab - sa * sb) / std::sqrt((n * aa - sa * sa) * (n * bb - sb * sb));
}

/// Largest distance between the distribution of ln(length) and the normal distribution with its
/// mean and deviation, divided by what a sample of that size exceeds in one case of twenty:
/// 0.886/sqrt(n).
/// source  [Lilliefors 1967]
double lognormal_distance(std::vector<double> lengths) {
  std::sort(lengths.begin(), lengths.end());
  const double n = static_cast<double>(lengths.size());
  double sum = 0, squares = 0;
  for (double& l : lengths) {
    l = std::log(l);
    sum += l;
    squares += l * l;
  }
  const double mean = sum / n, deviation = std::sqrt((squares - n * mean * mean) / (n - 1));
  double most = 0;
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    const double normal = 0.5 * std::erfc((mean - lengths[i]) / (deviation * std::sqrt(2.0)));
    most = std::max({most, std::abs(normal - i / n), std::abs(normal - (i + 1) / n)});
  }
  return most * std::sqrt(n) / 0.886;
}

}  // namespace

Rows crumple() {
  const Scene scene = read_scene(PAPERBAKE_SAMPLES "/S4_crumple.glb");
  constexpr int seeds = 4;
  double births = 0, least = 1e9, most = 0, growth = 0, length = 0, compaction = 0;
  std::vector<double> creases;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const Crumpled c = run(scene, seed);
    births += c.births / seeds;
    least = std::min(least, c.births);
    most = std::max(most, c.births);
    std::vector<double> logarithm;
    for (const double delta : c.compaction) logarithm.push_back(-std::log(delta));
    growth += correlation(logarithm, c.length) / seeds;
    length += c.length.back() / seeds;
    compaction += c.compaction.back() / seeds;
    creases.insert(creases.end(), c.creases.begin(), c.creases.end());
  }
  const std::string name = "hybrid 120";
  Rows rows{{name, "fewest singular points", 34, least, 26 / 34.0, "V8: 8 to 60", ""},
            {name, "most singular points", 34, most, 26 / 34.0, "V8: 8 to 60", ""},
            {name, "creases counted, all seeds", 100, static_cast<double>(creases.size()), 0,
             "V8: at least 100", ""},
            {name, "Lilliefors of ln length / 5 %", 0, lognormal_distance(creases), 1,
             "V8: log-normal", ""},
            {name, "corr. of length, ln 1/Delta", 1, growth, 0.1, "V8: l grows as ln 1/Delta", ""}};
  const double side = std::sqrt(area(scene.sheets.front().pattern));
  // [m] measured on Mylar of 10 cm, scaled by area
  const double law =
      5.2 * std::pow(side / 0.1, 2) * (1 - compaction) * std::log(1 + 0.063 / compaction);
  rows.push_back(
      {name, "length of creases, m", law, length, 0, "told: Gottesman, 10 cm Mylar", ""});
  rows.push_back({name, "sub-linear in repetitions", 0, 0, 0, "", "the scenes crumple once"});
  rows.push_back(
      {"fem, adaptive", "any", 0, 0, 0, "",
       "no singular points, and a crease is a band of edges, none of them folded by 20 degrees"});
  return rows;
}

}  // namespace paperbake::validation
