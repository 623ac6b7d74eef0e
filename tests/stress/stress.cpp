// Table: generated handle scripts, each of them run by a method in a process of its own that is
// ended when one frame takes more than --seconds of processor time.
//
//   build/paperbake_stress [--scripts N] [--seed S] [--method hybrid|fem|adaptive] [--jobs N]
//                          [--seconds N] [--triangles N] [--json FILE] [--only INDEX] [--rises]
//
// The default is 1,000 scripts with seed 1 by every method. Results do not depend on how many
// scripts run at a time. A script that dies or does not end is reported by its index, with what it
// did until then. The exit code is 1 when a script crashed, did not end, became nan or kept silent
// about a handle that could not be followed.
// feasible      in no frame are two handles farther apart than the paper between them is long
// c_m above 2   mean length error above 2 % in a frame, of feasible scripts
// unreported    a hard handle that is off by more than 1 % of the sheet (and 0.1 mm) and not
//               reported as jammed, or an impossible pair of which no handle is reported as jammed
//               in its worst frame
// remeshed      changes of a mesh: proposals that were accepted; with --rises also the changes
//               before a step, which relaxes them
// rises         only with --rises, which makes frames slower: changes after which the sheet at
//               rest, with its handles where they are, stores more than 1 % (and 1e-6 J) more than
//               before; this check leaves gravity out
// worst ms      the most expensive frame: CPU time of one thread

#include "core/geometry/measure.h"
#include "core/hands/handle_feasibility.h"
#include "core/methods/adaptive.h"
#include "core/methods/fem.h"
#include "core/methods/hybrid.h"
#include "tests/stress/scripts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace paperbake::stress {
namespace {

struct Run {
  int scripts = 1000, first = 0;
  std::uint32_t seed = 1;
  std::size_t jobs = std::max(1u, std::thread::hardware_concurrency());
  rlim_t seconds = 120;  // of processor time, for each frame
  int triangles = 3000;  // that adaptive may have
  bool watch_rises = false;
};

/// What the process of a script reports through a pipe after every frame and at its end.
struct MeshSwapResult {
  bool finished = false;  // all frames, or with an error that was reported
  bool threw = false;     // with such an error
  bool nan = false, feasible = true, unreported = false;
  int frames = 0, unconverged = 0, remeshed = 0, rises = 0;
  double c_m = 0, edge = 0, worst_ms = 0, triangles = 0;
  char error[200] = "";
};

MethodChoice make_method(const std::string& name, const Script& script, int triangles) {
  if (name == "fem") return fem(400);
  if (name == "adaptive") return adaptive(script.shot.pattern, triangles);
  return hybrid(script.shot.pattern, script.shot.paper, 120, CrumpleOptions{}, script.options.seed,
                0);
}

/// [J] that the sheet stores at rest with all vertices that handles need held where they are;
/// nothing when it does not come to rest, or touches itself.
std::optional<double> stored_at_rest(Sheet sheet, const Script& script,
                                     const RemeshContext& context) {
  PositionConstraints held;
  for (int v = 0; v < static_cast<int>(context.fixed.size()); ++v)
    if (context.fixed[v]) held.push_back({v, sheet.x.row(v)});
  ElasticOptions options;
  options.max_iterations = 200;
  Elastic elastic(script.shot.paper, options);
  std::optional<PlasticGrid> memory;
  if (context.plastic_grid) elastic.set_plastic_grid(&memory.emplace(*context.plastic_grid));
  elastic.set_mesh(sheet);
  const ElasticReport report = elastic.relax(sheet, {held}, context.now.dt, Relaxation::full);
  if (!report.converged || report.contact) return std::nullopt;
  return report.energy;
}

/// A method whose changes of mesh are counted.
class Watched : public Method {
 public:
  Watched(std::unique_ptr<Method> method, const Script& script, MeshSwapResult& v)
      : method_(std::move(method)), script_(script), v_(v) {}

  PatternMesh first_mesh(const Pattern& pattern, const std::vector<Vector2d>& points) override {
    return method_->first_mesh(pattern, points);
  }
  std::optional<Sheet> propose(const Sheet& sheet, const RemeshContext& context) override {
    return method_->propose(sheet, context);
  }
  void on_proposal_result(bool accepted, const FrameTime& now) override {
    method_->on_proposal_result(accepted, now);
  }
  MeshChange remesh(Sheet& sheet, const RemeshContext& context) override {
    const Sheet before = sheet;
    const MeshChange change = method_->remesh(sheet, context);
    if (change == MeshChange::none) return change;
    ++v_.remeshed;
    const std::optional<double> was = stored_at_rest(before, script_, context),
                                now = was ? stored_at_rest(sheet, script_, context) : was;
    v_.rises += now && *now > 1.01 * *was + 1e-6;
    return change;
  }
  int load_parts(const Sheet& sheet, double relative_handle_motion) const override {
    return method_->load_parts(sheet, relative_handle_motion);
  }
  bool finish(Sheet& sheet, const std::vector<int>& held) const override {
    return method_->finish(sheet, held);
  }
  BentParts parts(const Sheet& sheet) const override { return method_->parts(sheet); }
  void archive(Serializer& a) override { method_->archive(a); }

 private:
  std::unique_ptr<Method> method_;
  const Script& script_;
  MeshSwapResult& v_;
};

MethodChoice watched(const MethodChoice& method, const Script& script, MeshSwapResult& v) {
  return {method.name,
          [&, make = method.make] { return std::make_unique<Watched>(make(), script, v); }};
}

/// True if no handle of a clearly impossible pair is reported as jammed in the worst frame of the
/// pair.
bool goes_unsaid(const Script& script, const AnimatedFrame& f) {
  // [m] more than three handles can share without being noticed
  const double clearly = 0.003 * longer_side(script.shot.pattern);
  return std::any_of(
      script.impossible.begin(), script.impossible.end(), [&](const UnreachablePair& pair) {
        if (pair.frame != f.frame || pair.apart - pair.allowed < clearly) return false;
        for (std::size_t h = 0; h < f.handles.size(); ++h)
          if (const std::string& name = script.shot.handles[h].name;
              (name == pair.a || name == pair.b) && f.handles[h].state == HandleFrame::jammed)
            return false;
        return true;
      });
}

MeshSwapResult play(const Script& script, const std::string& method, const Run& run,
                    const std::function<void(const MeshSwapResult&)>& say) {
  MeshSwapResult v;
  v.feasible = script.impossible.empty();
  AnimateOptions options = script.options;
  if (method == "fem") options.plasticity = Plasticity::off;
  const double side = longer_side(script.shot.pattern);
  try {
    const MethodChoice plain = make_method(method, script, run.triangles);
    animate(script.shot, run.watch_rises ? watched(plain, script, v) : plain, options,
            [&](const AnimatedFrame& f) {
              ++v.frames;
              v.nan |= !f.sheet->x.allFinite() || !std::isfinite(f.statistics.energy);
              v.unconverged += !f.statistics.converged;
              if (f.statistics.remesh == FrameStatistics::accepted) {
                ++v.remeshed;
                v.rises += f.statistics.remesh_rise > 0.01;
              }
              const LengthDistortion d = length_distortion(*f.sheet);
              v.c_m = std::max(v.c_m, 100 * d.mean);
              v.edge = std::max(v.edge, 100 * d.largest);
              v.worst_ms = std::max(v.worst_ms, f.statistics.elastic_ms + f.statistics.geometry_ms);
              v.triangles = std::max(v.triangles, double(f.sheet->triangles.rows()));
              for (const HandleFrame& h : f.handles)
                v.unreported |= h.state == HandleFrame::held &&
                                (h.at - h.keyed).norm() > std::max(1e-4, 0.01 * side);
              v.unreported |= goes_unsaid(script, f);
              say(v);
              return true;
            });
    v.finished = v.frames == options.last_frame - options.first_frame + 1;
  } catch (const std::exception& error) {
    v.finished = v.threw = true;
    std::strncpy(v.error, error.what(), sizeof v.error - 1);
  }
  return v;
}

struct Outcome {
  MeshSwapResult verdict;
  bool crashed = false, endless = false;
};

struct Child {
  pid_t pid;
  int pipe, index;
};

// The process is ended when it takes more than `seconds` of processor time from now on; a frame
// that takes this long is taken for one that does not end. The whole script has no limit, because a
// slow machine is not a failure.
void allow_another(rlim_t seconds) {
  rusage used;
  getrusage(RUSAGE_SELF, &used);
  const rlim_t so_far = used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1;
  rlimit cpu;
  getrlimit(RLIMIT_CPU, &cpu);
  cpu.rlim_cur = std::min(cpu.rlim_max, so_far + seconds);
  setrlimit(RLIMIT_CPU, &cpu);
}

Child start(int index, const Run& run, const std::string& method) {
  int ends[2];
  if (pipe(ends) != 0) {
    std::perror("pipe");
    std::exit(1);
  }
  const pid_t pid = fork();
  if (pid == 0) {
    close(ends[0]);
    allow_another(run.seconds);
    const auto say = [&](const MeshSwapResult& v) {
      if (write(ends[1], &v, sizeof v) != sizeof v) _exit(1);
      allow_another(run.seconds);
    };
    say(play(make_script(index, run.seed), method, run, say));
    _exit(0);
  }
  close(ends[1]);
  return {pid, ends[0], index};
}

Outcome finish(const Child& child, int status) {
  Outcome o;
  for (MeshSwapResult v; read(child.pipe, &v, sizeof v) == sizeof v;) o.verdict = v;
  close(child.pipe);
  o.endless = WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU;
  o.crashed = !o.endless && (!WIFEXITED(status) || WEXITSTATUS(status) != 0);
  return o;
}

std::vector<Outcome> run_all(const Run& run, const std::string& method) {
  const int scripts = run.scripts;
  std::vector<Outcome> outcomes(scripts);
  std::map<pid_t, Child> running;
  for (int next = 0; next < scripts || !running.empty();) {
    while (next < scripts && running.size() < run.jobs) {
      const Child child = start(run.first + next, run, method);
      running[child.pid] = child;
      ++next;
    }
    int status = 0;
    const pid_t done = waitpid(-1, &status, 0);
    const auto found = running.find(done);
    if (found == running.end()) continue;
    outcomes[found->second.index - run.first] = finish(found->second, status);
    running.erase(found);
    std::fprintf(stderr, "\r%d of %d", static_cast<int>(next - running.size()), scripts);
  }
  std::fprintf(stderr, "\n");
  return outcomes;
}

struct Counts {
  int scripts = 0, finished = 0, threw = 0, nan = 0, crashed = 0, endless = 0, feasible = 0,
      c_m_above_2 = 0, unreported = 0, remeshed = 0, rises = 0, unconverged = 0;
  double worst_ms = 0, triangles = 0;
};

void count(Counts& c, const Outcome& o) {
  const MeshSwapResult& v = o.verdict;
  ++c.scripts;
  c.finished += v.finished;
  c.threw += v.threw;
  c.nan += v.nan;
  c.crashed += o.crashed;
  c.endless += o.endless;
  c.feasible += v.feasible;
  c.c_m_above_2 += v.feasible && v.c_m > 2;
  c.unreported += v.unreported;
  c.remeshed += v.remeshed;
  c.rises += v.rises;
  c.unconverged += v.unconverged > 0;
  c.worst_ms = std::max(c.worst_ms, v.worst_ms);
  c.triangles = std::max(c.triangles, v.triangles);
}

void print_row(const std::string& name, const Counts& c, bool watches) {
  std::printf("  %-28s %5d %8d %6d %5d %7d %7d %9d %11d %10d %8d %6s %11d %9.0f %6.0f\n",
              name.c_str(), c.scripts, c.finished, c.threw, c.nan, c.crashed, c.endless, c.feasible,
              c.c_m_above_2, c.unreported, c.remeshed,
              watches ? std::to_string(c.rises).c_str() : "-", c.unconverged, c.worst_ms,
              c.triangles);
}

nlohmann::ordered_json report(const std::string& method, const Run& run) {
  const int scripts = run.scripts, first = run.first;
  const std::uint32_t seed = run.seed;
  const std::vector<Outcome> outcomes = run_all(run, method);
  std::printf("%s, seed %u\n  %-28s %5s %8s %6s %5s %7s %7s %9s %11s %10s %8s %6s %11s %9s %6s\n",
              method.c_str(), seed, "", "all", "finished", "threw", "nan", "crashed", "endless",
              "feasible", "c_m above 2", "unreported", "remeshed", "rises", "unconverged",
              "worst ms", "most triangles");
  std::map<std::string, Counts> by_kind;
  Counts all;
  for (int k = 0; k < scripts; ++k) {
    count(by_kind[kinds()[(first + k) % kinds().size()]], outcomes[k]);
    count(all, outcomes[k]);
  }
  for (const std::string& kind : kinds())
    if (by_kind.count(kind)) print_row(kind, by_kind[kind], run.watch_rises);
  print_row("all", all, run.watch_rises);
  for (int k = 0; k < scripts; ++k) {
    const Outcome& o = outcomes[k];
    const MeshSwapResult& v = o.verdict;
    if (o.crashed || o.endless || v.nan || v.threw || v.unreported || (v.feasible && v.c_m > 2))
      std::printf(
          "  script %d (%s):%s%s%s%s%s c_m %.2f %%, edge %.1f %%, %d frames, %.0f triangles, worst "
          "frame %.0f ms %s\n",
          first + k, kinds()[(first + k) % kinds().size()].c_str(), o.crashed ? " crashed" : "",
          o.endless ? " endless" : "", v.nan ? " nan" : "", v.threw ? " threw" : "",
          v.unreported ? " unreported" : "", v.c_m, v.edge, v.frames, v.triangles, v.worst_ms,
          v.error);
  }
  std::fflush(stdout);
  return {{"method", method},
          {"seed", seed},
          {"scripts", all.scripts},
          {"finished", all.finished},
          {"nan", all.nan},
          {"crashed", all.crashed + all.endless},
          {"unreported_infeasible", all.unreported},
          {"c_m_above_2", all.c_m_above_2},
          {"worst_ms", all.worst_ms}};
}

}  // namespace
}  // namespace paperbake::stress

int main(int argc, char** argv) {
  paperbake::stress::Run run;
  std::vector<std::string> methods{"hybrid", "fem", "adaptive"};
  std::string json;
  for (int i = 1; i < argc; i += 2) {
    if (!std::strcmp(argv[i], "--rises")) {
      run.watch_rises = true;
      if (++i == argc) break;
    }
    if (i + 1 == argc) {
      std::fprintf(stderr,
                   "paperbake_stress [--scripts N] [--seed S] [--method M] [--jobs N] "
                   "[--seconds N] [--triangles N] [--json FILE] [--only I] [--rises]\n");
      return 2;
    }
    const std::string option = argv[i], value = argv[i + 1];
    if (option == "--scripts")
      run.scripts = std::max(1, std::atoi(value.c_str()));
    else if (option == "--seed")
      run.seed = static_cast<unsigned>(std::atoi(value.c_str()));
    else if (option == "--method")
      methods = {value};
    else if (option == "--jobs")
      run.jobs = std::max(1, std::atoi(value.c_str()));
    else if (option == "--seconds")
      run.seconds = std::max(1, std::atoi(value.c_str()));
    else if (option == "--triangles")
      run.triangles = std::max(120, std::atoi(value.c_str()));
    else if (option == "--json")
      json = value;
    else if (option == "--only") {
      run.first = std::atoi(value.c_str());
      run.scripts = 1;
    } else {
      std::fprintf(stderr, "paperbake_stress: unknown option %s\n", option.c_str());
      return 2;
    }
  }
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const std::string& method : methods) all.push_back(paperbake::stress::report(method, run));
  if (!json.empty()) std::ofstream(json) << (all.size() == 1 ? all.front() : all).dump(1) << "\n";
  const auto failed = [](const nlohmann::ordered_json& of_method) {
    return of_method["nan"] != 0 || of_method["crashed"] != 0 ||
           of_method["unreported_infeasible"] != 0;
  };
  return std::any_of(all.begin(), all.end(), failed) ? 1 : 0;
}
