// Simulates a scene and writes what it wants itself: one Wavefront OBJ for every frame.
//
//   own_output SCENE FOLDER [FRAMES]
//
// SCENE is an FBX or glTF file, FOLDER exists. After FRAMES frames it has seen enough, and cancels.

#include <paperbake/paperbake.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

using namespace paperbake;

/// x: positions in metres, z up. The triangles are counter-clockwise seen from the front.
static void write_obj(const std::string& path, const Points3& x, const Triangles& triangles) {
  std::ofstream file(path);
  for (int v = 0; v < x.rows(); ++v)
    file << "v " << x(v, 0) << ' ' << x(v, 1) << ' ' << x(v, 2) << '\n';
  for (int t = 0; t < triangles.rows(); ++t)  // OBJ counts from 1
    file << "f " << triangles(t, 0) + 1 << ' ' << triangles(t, 1) + 1 << ' ' << triangles(t, 2) + 1
         << '\n';
}

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: own_output SCENE FOLDER [FRAMES]\n");
    return 2;
  }
  const std::string folder = argv[2];
  int frames_left = argc > 3 ? std::atoi(argv[3]) : 1000000;

  try {
    const Scene scene = read_scene(argv[1]);
    for (const std::string& warning : scene.warnings) std::printf("%s\n", warning.c_str());

    simulate_scene(scene, {{"method", "hybrid"}}, [&](const AnimatedFrame& frame) {
      // The frame is ours until this function returns: what is to be kept has to be copied.
      const Sheet& sheet = *frame.sheet;
      const std::string name =
          scene.sheets[frame.sheet_index].name + "." + std::to_string(frame.frame);
      write_obj(folder + "/" + name + ".obj", sheet.x, sheet.triangles);
      std::printf("%s: %ld vertices, %zu singular points\n", name.c_str(),
                  static_cast<long>(sheet.x.rows()), sheet.singular.size());
      return --frames_left > 0;  // false cancels
    });
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code);
  }
}
