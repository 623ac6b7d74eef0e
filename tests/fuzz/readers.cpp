#include "tests/fuzz/readers.h"

#include "baker/check/verify.h"
#include "baker/job/job_settings.h"
#include "baker/output/cache_judge.h"
#include "baker/output/checkpoints.h"
#include "baker/output/file_hash.h"
#include "core/methods/hybrid.h"
#include "core/model/error.h"
#include "formats/cache/alembic_cache.h"
#include "formats/cache/alembic_reader.h"
#include "formats/cache/content_hash.h"
#include "formats/config/lock_file.h"
#include "formats/config/preset_file.h"
#include "formats/scene/gltf_curves.h"
#include "formats/scene/import_serialization.h"
#include "formats/scene/scene_fbx.h"
#include "formats/scene/scene_file.h"
#include "formats/scene/scene_import.h"
#include "tests/core/test_shots.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <unistd.h>

namespace paperbake::fuzz {
namespace {

namespace fs = std::filesystem;

/// A folder for this process alone, removed when the process ends; in memory where the system
/// allows that.
struct Folder {
  fs::path path;
  Folder() {
    std::error_code none;
    const fs::path memory = "/dev/shm";
    path = (fs::is_directory(memory, none) ? memory : fs::temp_directory_path()) /
           ("paperbake_fuzz_" + std::to_string(::getpid()));
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

/// Makes the call; an Error is as good as a return when it has a place and a cause.
template <class Call>
void ends_well(Call call) {
  try {
    call();
  } catch (const Error& error) {
    if (error.place.empty() || error.cause.empty())
      throw std::logic_error(std::string("an error without place or cause: ") + error.what());
  }
}

/// The same for readers whose callers name the file: a Damage may reject the bytes.
template <class Call>
void ends_well_or_refuses(Call call) {
  ends_well([&] {
    try {
      call();
    } catch (const Damage&) {
    } catch (const nlohmann::json::exception&) {
    }
  });
}

void takes_of(const std::filesystem::path& path) {
  GltfFile file(path, Parts::of_its_folder);
  gltf_takes(file);
}

const char* gltf_name(const std::string& bytes) {
  return bytes.rfind("glTF", 0) == 0 ? "scene.glb" : "scene.gltf";
}

fs::path scene_file(const std::string& bytes) {
  const bool gltf = bytes.rfind("glTF", 0) == 0 || bytes.rfind("{", 0) == 0;
  return written(gltf ? gltf_name(bytes) : "scene.fbx", bytes);
}

void read_cache(const std::string& bytes) {
  constexpr std::size_t most = 20;  // sheets, frames: a file may claim many equal ones
  const fs::path path = written("read.abc", bytes);
  ends_well([&] {
    const AlembicReader cache(path);
    for (std::size_t s = 0; s < std::min(most, cache.sheets().size()); ++s)
      for (std::size_t i = 0; i < std::min(most, cache.sheets()[s].frames); ++i) {
        const CacheFrame frame = cache.frame(s, i);
        if (frame.uv.rows() > 0) CacheJudge(frame.uv, frame.triangles, 0.1, nullptr)(frame.x, 0);
        cache.content_hash(s, i);
      }
  });
}

/// A cache of two triangles with three frames.
fs::path small_cache() {
  const fs::path path = written("cache.abc", "");
  CacheFrame frame;
  frame.x.resize(4, 3);
  frame.uv.resize(4, 2);
  frame.triangles.resize(2, 3);
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
  written("cert/handles.csv", parts[0]);
  written("cert/frames.jsonl", parts[1]);
  written("cert/summary.json", parts[2]);
  ends_well([&] {
    const Verification found = verify(folder);
    verification_text(folder, found);
    verification_json(found);
  });
}

/// Valid bytes with changes applied. Each change has 13 bytes: the position, how many bytes to
/// replace (1, 2, 4 or 8), and by which. If at least four bytes are left over, they are the length
/// to which the result is cut.
std::string changed(std::string bytes, const std::string& changes) {
  const auto number = [&](std::size_t at, std::size_t size) {
    std::uint64_t value = 0;
    std::memcpy(&value, changes.data() + at, size);
    return value;
  };
  std::size_t at = 0;
  for (; at + 13 <= changes.size(); at += 13) {
    const std::uint64_t where = number(at, 4) % bytes.size(), value = number(at + 5, 8);
    std::memcpy(bytes.data() + where, &value,
                std::min(bytes.size() - where, std::size_t(1) << number(at + 4, 1) % 4));
  }
  if (at + 4 <= changes.size()) bytes.resize(number(at, 4) % bytes.size());
  return bytes;
}

/// A table that rises to a sheet at height zero within 12 frames.
Collider rising_table() {
  ColliderMesh mesh;
  mesh.name = "table";
  mesh.x.resize(4, 3);
  mesh.x << -1, -1, -0.0014, 1, -1, -0.0014, 1, 1, -0.0014, -1, 1, -0.0014;
  mesh.triangles.resize(2, 3);
  mesh.triangles << 0, 1, 2, 0, 2, 3;
  for (int frame = 0; frame < 12; ++frame) {
    mesh.frames.own().push_back(mesh.x);
    mesh.frames.own().back().col(2).array() += 1e-4 * frame;
  }
  return Collider(mesh);
}

/// A coarse sheet that was pushed until it bent, above a table, and the state from which its next
/// frame is computed.
struct Pushed {
  Shot shot = test::s1_push();
  AnimateOptions options;
  std::string state;
  Pushed() {
    shot.colliders = std::make_shared<const Colliders>(Colliders{rising_table()});
    options.last_frame = 12;
    options.plasticity = Plasticity::on;
    animate(shot, method(), options, [&](const AnimatedFrame& frame) {
      state = frame.state();
      return true;
    });
  }
  MethodChoice method() const { return hybrid(shot.pattern, shot.paper, 40, {}, 1, 0); }
};

void read_state(const std::string& changes) {
  static const Pushed pushed;
  AnimateOptions options = pushed.options;
  options.resume_state = changed(pushed.state, changes);
  ends_well([&] {
    animate(pushed.shot, pushed.method(), options, [](const AnimatedFrame&) { return false; });
  });
}

/// A bake of two frames with a checkpoint.
struct Kept {
  BakePlan plan;
  fs::path folder = written("checkpoint.000002", "").parent_path();
  std::string body;  // the checkpoint without its seal
  Kept() {
    BakeSettings settings;
    settings.scene = PAPERBAKE_SAMPLES "/S1_push.glb";
    settings.base_triangles = 40;
    settings.frames = FrameSpan{1, 2, 1};
    plan = plan_bake(settings);
    Checkpoints checkpoints(folder, plan, 2);
    simulate(plan, {plan.animation}, 1, [&](const AnimatedFrame& frame) {
      checkpoints.add(frame);
      return true;
    });
    std::ifstream file(folder / "checkpoint.000002", std::ios::binary);
    body.assign(std::istreambuf_iterator<char>(file), {});
    body.resize(body.size() - hex(content_hash("")).size());
  }
};

void read_checkpoint(const std::string& changes) {
  static const Kept kept;
  const std::string body = changed(kept.body, changes);
  written("checkpoint.000002", body + hex(content_hash(body)));
  Checkpoints(kept.folder, kept.plan, 2).load([](const AnimatedFrame&) { return true; });
}

}  // namespace

const std::map<std::string, Reader>& readers() {
  static const std::map<std::string, Reader> all{
      {"scene",
       [](const std::string& bytes) { ends_well([&] { read_scene(scene_file(bytes)); }); }},
      {"import",
       [](const std::string& bytes) {
         ends_well([&] { serialize({import_in_process(scene_file(bytes)), "", "", ""}); });
       }},
      {"imported",
       [](const std::string& bytes) {
         ends_well_or_refuses([&] { scene_of(deserialize(bytes).file, "message"); });
       }},
      {"gltf_curves",
       [](const std::string& bytes) {
         ends_well_or_refuses([&] { takes_of(written(gltf_name(bytes), bytes)); });
       }},
      {"fbx",
       [](const std::string& bytes) {
         ends_well([&] { import_fbx(written("scene.fbx", bytes), std::nullopt); });
       }},
      {"preset",
       [](const std::string& bytes) {
         ends_well([&] { read_preset(written("preset.toml", bytes)); });
       }},
      {"lock",
       [](const std::string& bytes) {
         ends_well([&] { read_lock(written("lock.toml", bytes)); });
       }},
      {"job",
       [](const std::string& bytes) {
         ends_well([&] {
           BakeSettings settings;
           load_job(settings, written("job.toml", bytes));
         });
       }},
      {"certificate", read_certificate},
      {"cache", read_cache},
      {"state", read_state},
      {"checkpoint", read_checkpoint}};
  return all;
}

}  // namespace paperbake::fuzz
