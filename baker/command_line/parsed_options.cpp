#include "baker/command_line/parsed_options.h"

#include "baker/bake/stop_signals.h"
#include "baker/job/job_settings.h"
#include "baker/job/options.h"
#include "core/model/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace paperbake {

void add_option(ParsedOptions& parsed, const std::string& name, const std::string& flags) {
  const Option& o = option(name);
  std::string& text = parsed.text[name];
  const std::string& spelled = flags.empty() ? o.flags : flags;
  if (o.kind == JobKey::flag) {
    parsed.command->add_flag(spelled, text, o.help);
    return;
  }
  CLI::Option* added = parsed.command->add_option(spelled, text, o.help);
  if (!o.default_value.empty()) added->default_str(o.default_value);
  if (o.kind == JobKey::word)
    added->type_name(fmt::format("{}", fmt::join(o.words, "|")));
  else if (o.kind != JobKey::list)
    added->type_name(o.kind == JobKey::number ? "NUMBER" : o.kind == JobKey::whole ? "N" : "TEXT");
}

void add_reading_options(ParsedOptions& parsed) {
  for (const char* name : {"fps", "start_frame", "unit_scale", "take", "allow_outside"})
    add_option(parsed, name);
}

void add_set(ParsedOptions& parsed) {
  parsed.command->add_option("--set", parsed.set,
                             "key=value: one number of the paper, over preset and scene; "
                             "friction=0: its layers slide freely");
}

void add_all_options(ParsedOptions& parsed) {
  add_option(parsed, "scene", "SCENE");
  parsed.command->get_option("SCENE")->required()->description(
      "An .fbx, .glb or .gltf file with a sheet and animated handles, or a job file (.toml)");
  add_option(parsed, "output", "-o,--output");
  for (const Option& o : options())
    if (o.name != "scene" && o.name != "output") add_option(parsed, o.name);
  add_set(parsed);
}

void apply_command_line(const ParsedOptions& parsed, BakeSettings& settings) {
  const auto scene = parsed.text.find("scene");
  const bool job = scene != parsed.text.end() && is_job(scene->second);
  if (job) load_job(settings, scene->second);
  for (const Option& o : options()) {
    const CLI::Option* given =
        parsed.text.count(o.name)
            ? parsed.command->get_option_no_throw(o.name == "scene" ? "SCENE" : o.flags)
            : nullptr;
    if (given && given->count() > 0 && !(job && o.name == "scene"))
      apply_option(settings, o, parsed.text.at(o.name), o.flags, Origin::command);
  }
  for (const std::string& text : parsed.set) settings.set.push_back(parse_set(text));
}

void require_output(const BakeSettings& settings, const char* remedy) {
  if (settings.output.empty())
    throw Error(ErrorCode::command, "command line", "--output is required: the folder to write to.",
                remedy);
}

bool is_stop_asked() { return StopSignals::asked(); }

}  // namespace paperbake
