#include "tests/fuzz/readers.h"

#include "baker/cache_measure.h"
#include "baker/job.h"
#include "baker/verify.h"
#include "core/error.h"
#include "formats/alembic_cache.h"
#include "formats/alembic_reader.h"
#include "formats/lock_file.h"
#include "formats/preset_file.h"
#include "formats/scene_file.h"
#include "formats/scene_import.h"
#include "formats/scene_message.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <unistd.h>

namespace paperbake::fuzz {
namespace {

namespace fs = std::filesystem;

/// A folder of this process, which goes with it; in memory where the system has that.
struct Folder {
  fs::path path;
  Folder() {
    std::error_code none;
    const fs::path memory = "/dev/shm";
    path = (fs::is_directory(memory, none) ? memory : fs::temp_directory_path()) / ("paperbake_fuzz_" + std::to_string(::getpid()));
    fs::create_directories(path / "cert");
  }
  ~Folder() {
    std::error_code none;
    fs::remove_all(path, none);
  }
};

fs::path written(const std::string& name, const std::string& bytes) {
  static const Folder folder;
  const fs::path path = folder.path / name;
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

/// Errors are an end like any other when they say where and what.
template <class Call>
void ends_well(Call call) {
  try {
    call();
  } catch (const Error& error) {
    if (error.place.empty() || error.cause.empty()) throw std::logic_error(std::string("an error without place or cause: ") + error.what());
  }
}

fs::path scene_file(const std::string& bytes) {
  return written(bytes.rfind("glTF", 0) == 0 ? "scene.glb" : bytes.rfind("{", 0) == 0 ? "scene.gltf" : "scene.fbx", bytes);
}

void read_cache(const std::string& bytes) {
  constexpr std::size_t most = 20;  // frames: a file may say that it has many that are the same
  const fs::path path = written("read.abc", bytes);
  ends_well([&] {
    const AlembicReader cache(path);
    for (std::size_t s = 0; s < std::min(most, cache.sheets().size()); ++s)
      for (std::size_t i = 0; i < std::min(most, cache.sheets()[s].frames); ++i) {
        const CacheFrame frame = cache.frame(s, i);
        if (frame.uv.rows() > 0) cache_distortion(frame, 0.1);
        cache.content_hash(s, i);
      }
  });
}

/// Two triangles over three frames.
fs::path small_cache() {
  const fs::path path = written("cache.abc", "");
  CacheFrame frame;
  frame.x.resize(4, 3), frame.uv.resize(4, 2), frame.triangles.resize(2, 3);
  frame.uv << 0, 0, 1, 0, 0, 1, 1, 1;
  frame.x << 0.1 * frame.uv, Eigen::Vector4d::Zero();
  frame.triangles << 0, 1, 3, 0, 3, 2;
  AlembicWriter writer(path, CacheInfo{}, {"paper"});
  for (int i = 0; i < 3; ++i) writer.add_frame(0, frame);
  writer.finish();
  return path;
}

void read_certificate(const std::string& bytes) {
  static const fs::path folder = small_cache().parent_path();
  std::array<std::string, 3> parts;
  std::size_t part = 0;
  for (const char c : bytes) c == '\x1e' && part < 2 ? void(++part) : parts[part].push_back(c);
  if (parts[2].find('}') != std::string::npos) parts[2] = sealed(parts[2]);
  written("cert/handles.csv", parts[0]), written("cert/frames.jsonl", parts[1]), written("cert/summary.json", parts[2]);
  ends_well([&] {
    const Verification found = verify(folder);
    verification_text(folder, found);
    verification_json(found);
  });
}

}  // namespace

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all{
      {"scene", [](const std::string& bytes) { ends_well([&] { read_scene(scene_file(bytes)); }); }},
      {"import", [](const std::string& bytes) { ends_well([&] { bytes_of({import_here(scene_file(bytes)), "", "", ""}); }); }},
      {"imported", [](const std::string& bytes) {
         ends_well([&] {
           try {
             scene_of(message_of(bytes).file, "message");
           } catch (const std::runtime_error& error) {  // what is no message is refused
             if (dynamic_cast<const Error*>(&error)) throw;
           }
         });
       }},
      {"preset", [](const std::string& bytes) { ends_well([&] { read_preset(written("preset.toml", bytes)); }); }},
      {"lock", [](const std::string& bytes) { ends_well([&] { read_lock(written("lock.toml", bytes)); }); }},
      {"job", [](const std::string& bytes) {
         ends_well([&] {
           BakeSettings settings;
           take_job(settings, written("job.toml", bytes));
         });
       }},
      {"certificate", read_certificate},
      {"cache", read_cache}};
  return all;
}

}  // namespace paperbake::fuzz
