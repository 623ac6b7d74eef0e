// Bakes a sheet that exists in code only: no scene file is read.
//
//   bake_a_sheet FOLDER
//
// A sheet of 120 x 60 mm lies on the plane z = 0. Four handles hold its corners, and the two on the
// right come 30 mm closer in one second, so that the sheet bends into an arch. The cache, maps,
// certificate and report are written to FOLDER. Ctrl-C stops the bake; started again, it goes on.

#include <paperbake/paperbake.h>

#include <csignal>
#include <cstdio>

using namespace paperbake;

static volatile std::sig_atomic_t stop = 0;

/// A handle at the point (u, v) of the flat sheet, which moves by `way` in equal steps. All lengths
/// are in metres. A handle has one position for every frame.
static Handle moving_handle(const char* name, double u, double v, const Vector3d& way, int frames) {
  Points3 positions(frames, 3);
  for (int f = 0; f < frames; ++f) positions.row(f) = Vector3d(u, v, 0) + way * f / (frames - 1);
  return Handle{name, Vector2d(u, v), positions};
}

static Scene sheet_pushed_together() {
  Scene scene;
  scene.source = "arch";  // begins the names of the output files
  scene.fps = 24;
  scene.first_frame = 1;
  scene.last_frame = 25;

  const double width = 0.12, height = 0.06;
  const Vector3d still(0, 0, 0), to_the_left(-0.03, 0, 0);
  SceneSheet sheet = flat_sheet("paper", width, height);
  sheet.preset = "copy90";  // one of the grades that `paperbake presets` lists
  sheet.handles = {moving_handle("front left", 0, 0, still, 25),
                   moving_handle("back left", 0, height, still, 25),
                   moving_handle("front right", width, 0, to_the_left, 25),
                   moving_handle("back right", width, height, to_the_left, 25)};
  scene.sheets.push_back(sheet);
  return scene;
}

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: bake_a_sheet FOLDER\n");
    return 2;
  }
  std::signal(SIGINT, [](int) { stop = 1; });

  BakeCallbacks callbacks;
  callbacks.on_progress = [](const BakeProgress& p) {
    std::printf("%s frame %d (%d of %d)\n", p.pass.c_str(), p.frame, p.done, p.frames);
  };
  callbacks.on_message = [](const std::string& text) { std::printf("%s\n", text.c_str()); };
  callbacks.cancel = [] { return stop != 0; };

  try {
    // options have the names and values of the command line
    const BakeJob job{{"quality", "draft"}, {"map_size", "256"}};
    const BakeResult result = bake_scene(sheet_pushed_together(), argv[1], job, callbacks);
    for (const auto& file : result.files) std::printf("wrote %s\n", file.c_str());
    for (const auto& gate : result.missed_gates) std::printf("gate missed: %s\n", gate.c_str());
  } catch (const Error& error) {  // place, cause and remedy, each on its own line
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code);
  }
}
