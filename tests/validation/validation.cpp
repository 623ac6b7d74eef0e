// Table: closed forms and laws against what this program computes. The exit code is 1 when a line
// of the table fails.
//
//   paperbake_validation [CASE...]        CASE: V1 to V9; default: all. One thread.

#include "tests/validation/cases.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace paperbake::validation {
namespace {

struct Case {
  const char *name, *title;
  Rows (*run)();
};
constexpr Case cases[] = {
    {"V1", "elastica: a sheet of 100 x 100 mm, two hinged borders 10 % closer", elastica},
    {"V2", "heavy cantilever: a strip clamped level, lam = rho g L^3/D, nu = 0", cantilever},
    {"V3",
     "d-cone: paper between radii of 15 and 50 mm about its tip, and whole discs, pushed into a "
     "ring of slope eps",
     d_cone},
    {"V4",
     "e-cone: paper with an excess angle phi between radii of 15 and 50 mm about its tip, free",
     e_cone},
    {"V5",
     "stretching ridge: two opposite borders X = 100 mm apart, folded to a dihedral of 90 degrees",
     ridge},
    {"V6", "Moebius strip of 300 x 30 mm, closed; box: of its centre line", moebius},
    {"V7", "a strip wound to a curvature k and let go; yield at 100 1/m", wound_strip},
    {"V8", "crumpling statistics: S4_crumple.glb, plastic, seeds 1 to 4", crumple},
    {"V9", "exactness of S1 (an arch pushed up and let down), and of scenes where they are named",
     exactness},
};

/// returns  how many lines failed
int print(const Case& c) {
  std::printf("%s  %s\n", c.name, c.title);
  std::fflush(stdout);
  int failed = 0;
  for (const Row& row : c.run()) {
    if (!row.cannot.empty()) {
      std::printf("    %-34s %-30s cannot: %s\n", row.name.c_str(), row.quantity.c_str(),
                  row.cannot.c_str());
      continue;
    }
    failed += !row.passed();
    const bool absolute = row.expected == 0;
    char off[40] = "", tolerance[40] = "";
    std::snprintf(off, sizeof off, absolute ? "%+.3g" : "%+.2f %%",
                  absolute ? row.off() : 100 * row.off());
    if (row.judged())
      std::snprintf(tolerance, sizeof tolerance, absolute ? "%.3g" : "%.2g %%",
                    absolute ? row.tolerance : 100 * row.tolerance);
    std::printf("    %-34s %-30s %11.5g %11.5g %10s %8s  %-28s %s\n", row.name.c_str(),
                row.quantity.c_str(), row.expected, row.got, off, tolerance, row.source.c_str(),
                !row.judged()  ? ""
                : row.passed() ? "pass"
                               : "FAIL");
  }
  std::fflush(stdout);
  return failed;
}

}  // namespace
}  // namespace paperbake::validation

int main(int argc, char** argv) {
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
  std::printf("    %-34s %-30s %11s %11s %10s %8s  %-28s\n", "mesh or method", "quantity",
              "expected", "got", "off", "tolerance", "source");
  int failed = 0, run = 0;
  for (const auto& c : paperbake::validation::cases) {
    bool wanted = argc < 2;
    for (int i = 1; i < argc; ++i) wanted |= std::strcmp(argv[i], c.name) == 0;
    if (wanted) {
      failed += print(c);
      ++run;
    }
  }
  std::printf("%d cases, %d lines failed\n", run, failed);
  return failed > 0 || run == 0;
}
