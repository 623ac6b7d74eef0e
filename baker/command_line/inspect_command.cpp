#include "baker/check/inspect.h"
#include "baker/command_line/command.h"
#include "baker/command_line/parsed_options.h"
#include "baker/job/job_settings.h"
#include "baker/output/say.h"
#include "formats/files/atomic_file.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

struct InspectArguments : ParsedOptions {
  std::filesystem::path file;
  bool json = false;
  std::optional<std::string> tracks;  // file, or - for stdout
};

void add_inspect(CLI::App& app, InspectArguments& parsed) {
  CLI::App& inspect = *app.add_subcommand(
      "inspect",
      "Show what is in a scene or a baked cache, what is wrong with it, and where each value came "
      "from");
  parsed.command = &inspect;
  inspect
      .add_option("FILE", parsed.file,
                  "An .fbx, .glb or .gltf scene, a job file (.toml), or an .abc cache")
      ->required();
  inspect.add_flag("--json", parsed.json, "Print JSON");
  inspect.add_option("--tracks", parsed.tracks,
                     "Write frame,node,x,y,z of every node to this file (world space, z up, "
                     "metres); - for stdout");
  add_reading_options(parsed);
}

int run_inspect(const InspectArguments& parsed) {
  BakeSettings settings;
  const bool job = is_job(parsed.file);
  if (job)
    load_job(settings, parsed.file);
  else
    settings.scene = parsed.file;
  apply_command_line(parsed, settings);
  if (parsed.tracks) {
    const std::string csv = tracks_csv(settings.scene, settings.reading);
    if (*parsed.tracks == "-")
      print_data(csv);
    else
      write_atomically(*parsed.tracks, csv);
    return 0;
  }
  const bool cache = parsed.file.extension() == ".abc";
  print_data(cache ? inspect_cache(parsed.file, parsed.json)
             : job ? inspect_job(settings, parsed.json)
                   : inspect_scene(parsed.file, settings.reading, parsed.json));
  return 0;
}

}  // namespace

Command inspect_command(CLI::App& app) {
  const auto parsed = std::make_shared<InspectArguments>();
  add_inspect(app, *parsed);
  return {parsed->command, [=] { return run_inspect(*parsed); }};
}

}  // namespace paperbake
