#include "formats/scene/scene_import.h"

#include "core/model/error.h"
#include "formats/files/atomic_file.h"
#include "formats/scene/import_serialization.h"
#include "formats/scene/sandbox.h"
#include "formats/scene/scene_fbx.h"
#include "formats/scene/scene_gltf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string_view>

namespace paperbake {
namespace {

// Limits of an import, far above its needs: two million triangles in a GLB of 36 MB take 180 MB and
// 0.2 s.
constexpr std::uint64_t min_memory = std::uint64_t(512) << 20;   // [bytes]
constexpr std::uint64_t memory_per_byte = 10;                    // [bytes] per byte of the file
constexpr unsigned min_seconds = 5, bytes_per_second = 1 << 20;  // of CPU time

[[noreturn]] void reject(const std::filesystem::path& path, const std::string& cause,
                         const std::string& remedy = export_again) {
  throw Error(ErrorCode::scene, path.string(), cause, remedy);
}

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

/// A pointer of Git LFS, and text in a file that should be binary. `file` stays at its beginning.
void refuse_text(const std::filesystem::path& path, const std::string& extension,
                 std::istream& file) {
  char head[64] = {};
  file.read(head, sizeof head);
  const std::string_view begin(head, static_cast<std::size_t>(file.gcount()));
  file.clear();
  file.seekg(0);
  if (begin.rfind("version https://git-lfs.github.com/", 0) == 0)
    reject(path, "This is a pointer of Git LFS, which stands for the file in a repository.",
           "Fetch the file itself: git lfs pull.");
  const bool text = std::all_of(begin.begin(), begin.end(), [](unsigned char c) {
    return (c >= 32 && c != 127) || c == '\t' || c == '\n' || c == '\r';
  });
  if (extension != ".glb" || !text) return;
  if (begin.find_first_not_of(" \t\r\n\xEF\xBB\xBF") != std::string_view::npos &&
      begin[begin.find_first_not_of(" \t\r\n\xEF\xBB\xBF")] == '{')
    return;  // glTF with the wrong ending
  reject(path, begin.empty() ? "The file is empty." : "This is a text, not a GLB file.",
         "Export the scene from the DCC as .glb.");
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

/// Reports what can be seen without the importer, in clearer words than it would.
void check_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    reject(path, "There is no such file.", "Check the path.");
  if (!std::filesystem::is_regular_file(path, error))
    reject(path,
           fmt::format("This is not a file, but {}.",
                       kind_of_no_file(path).empty() ? "something else" : kind_of_no_file(path)),
           "Name an FBX, glTF or GLB file.");
  const std::string extension = lower_case_extension(path);
  if (extension == ".usda" || extension == ".usdc")
    reject(path, "This is a USD layer, which is written but not read here.",
           "Name the .abc of a bake, or a scene as .fbx, .gltf or .glb.");
  if (extension != ".fbx" && extension != ".gltf" && extension != ".glb")
    reject(path, "This is not an FBX, glTF or GLB file.",
           "Export the scene from the DCC as .fbx, .gltf or .glb.");
  std::ifstream file(path, std::ios::binary);
  if (!file) reject(path, "The file cannot be opened.", "Check its read permission.");
  refuse_text(path, extension, file);
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  unsigned char head[12] = {};
  if (extension != ".glb" || !file.read(reinterpret_cast<char*>(head), sizeof head)) return;
  if (!std::equal(head, head + 4, "glTF")) return;
  const auto number = [&](int at) {
    return head[at] | head[at + 1] << 8 | head[at + 2] << 16 | std::uintmax_t(head[at + 3]) << 24;
  };
  const std::uintmax_t version = number(4), promised = number(8);
  if (version != 2)
    reject(path, fmt::format("This is GLB of version {}; only version 2 can be read.", version),
           "Export the scene as glTF 2.0.");
  if (promised > size)
    reject(path, fmt::format("The file is cut off: it has {} of its {} bytes.", size, promised),
           "Copy or export it again.");
}

/// Whether the first bytes of a file are those of glTF, whatever its name.
bool is_gltf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string head(4, '\0');
  file.read(head.data(), 4);
  const std::size_t first = head.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  return head == "glTF" || (first != std::string::npos && head[first] == '{');
}

}  // namespace

Error foreign_file(const std::filesystem::path& path) {
  return Error(ErrorCode::scene, path.string(),
               "This is not an FBX, glTF 2 or GLB file, whatever its name says.",
               "Export the scene from the DCC as .fbx, .gltf or .glb.");
}

ImportedFile import_in_process(const std::filesystem::path& path, std::optional<double> fps,
                               Parts parts) try {
  return is_gltf(path) ? import_gltf(path, parts) : import_fbx(path, fps);
} catch (const Error& error) {
  if (error.place == path.string()) throw;
  throw Error(error.code, path.filename().string() + ", " + error.place, error.cause, export_again);
} catch (const std::bad_alloc&) {
  reject(path, "The file asks for more memory than a scene of its size needs.");
} catch (const std::exception& error) {
  reject(path, fmt::format("The file cannot be read: {}.", error.what()));
}

ImportedFile import_file(const std::filesystem::path& path, std::optional<double> fps,
                         Parts parts) {
  check_file(path);
  std::error_code unknown;
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  const auto import = [&] {
    try {
      return serialize({import_in_process(path, fps, parts), "", "", ""});
    } catch (const Error& error) {
      return serialize({{}, error.place, error.cause, error.remedy});
    }
  };
  SandboxLimits limits{min_memory + memory_per_byte * size,
                       min_seconds + static_cast<unsigned>(size / bytes_per_second)};
  if (parts == Parts::of_its_folder) {
    limits.readable = {folder_of(path)};
    if (const auto file = std::filesystem::canonical(path, unknown); !unknown)
      limits.readable.push_back(folder_of(file));
  }
  const SandboxResult sandboxed = run_sandboxed(import, limits);
  if (!sandboxed.bytes)
    reject(path, fmt::format("The file cannot be read: its import {}.", sandboxed.ended));
  try {
    ImportResult result = deserialize(*sandboxed.bytes);
    if (!result.cause.empty())
      throw Error(ErrorCode::scene, result.place, result.cause, result.remedy);
    return std::move(result.file);
  } catch (const Damage& damage) {
    reject(path, fmt::format("The file cannot be read: {}.", damage.what()));
  }
}

}  // namespace paperbake
