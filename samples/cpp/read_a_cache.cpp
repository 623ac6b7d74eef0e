// Reads an Alembic cache that paperbake wrote, and prints how high the sheets rise in every frame.
//
//   read_a_cache FILE.abc
//
// It links paperbake::formats alone, which reads and writes files and bakes nothing.

#include <paperbake/core/model/error.h>
#include <paperbake/formats/cache/alembic_reader.h>

#include <cstdio>

using namespace paperbake;

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: read_a_cache FILE.abc\n");
    return 2;
  }
  try {
    const AlembicReader cache(argv[1]);
    std::printf("%g frames a second\n", cache.info().fps);
    for (std::size_t s = 0; s < cache.sheets().size(); ++s) {
      const AlembicReader::Sheet& sheet = cache.sheets()[s];
      std::printf("sheet %s: %zu frames\n", sheet.name.c_str(), sheet.frames);
      for (std::size_t i = 0; i < sheet.frames; ++i) {
        // a row of x is a vertex in metres, z up; triangles, velocity, normal and uv are there too
        const CacheFrame frame = cache.frame(s, i);
        const int number = cache.info().first_frame + static_cast<int>(i) * cache.info().frame_step;
        std::printf("frame %d: %ld vertices, from %.2f to %.2f mm\n", number,
                    static_cast<long>(frame.x.rows()), 1e3 * frame.x.col(2).minCoeff(),
                    1e3 * frame.x.col(2).maxCoeff());
      }
    }
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return static_cast<int>(error.code);
  }
}
