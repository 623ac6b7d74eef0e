#include <paperbake/paperbake.h>

#include <cstdio>

/// Bakes six frames of a scene as a draft. returns the exit code of the program for that
extern "C" int bake_six_frames(const char* scene, const char* folder) {
  try {
    const paperbake::BakeJob job{{"quality", "draft"}, {"frames", "1-6"}, {"formats", "abc,cert"}};
    const auto result = paperbake::bake_scene(paperbake::read_scene(scene), folder, job);
    for (const auto& file : result.files) std::printf("%s\n", file.c_str());
    return result.missed_gates.empty() ? 0 : 4;
  } catch (const paperbake::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code);
  }
}
