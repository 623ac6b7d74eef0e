#include "baker/bake/bake.h"
#include "baker/command_line/command.h"
#include "baker/command_line/parsed_options.h"
#include "baker/job/job_settings.h"
#include "baker/job/used_values.h"
#include "baker/output/say.h"
#include "baker/studies/accuracy_search.h"
#include "core/model/error.h"
#include "formats/files/atomic_file.h"

#include <memory>

namespace paperbake {
namespace {

/// Of `bake` beyond the options of the table.
struct BakeArguments : ParsedOptions {
  std::optional<std::filesystem::path> write_job, log;
  bool dry_run = false, force = false;
};

void add_bake(CLI::App& app, BakeArguments& parsed) {
  parsed.command = app.add_subcommand(
      "bake", "Simulate the sheets of a scene and write cache, maps and certificate");
  add_all_options(parsed);
  parsed.command->add_flag("--dry-run", parsed.dry_run,
                           "Check everything and print the job, but write nothing");
  parsed.command->add_option("--write-job", parsed.write_job,
                             "Write a job file that says the same, with all that it could say; "
                             "without -o that is all that is done. Refuses to overwrite a file. "
                             "-: to stdout");
  parsed.command->add_flag("--force", parsed.force, "Let --write-job overwrite a file");
  parsed.command->add_option(
      "--log", parsed.log,
      "Append every line of progress, every warning and the end to this file, with times (UTC)");
}

/// throws Error(ErrorCode::command) when the job would overwrite something, such as the scene
void write_job(const BakeArguments& parsed, const BakeSettings& settings) {
  if (*parsed.write_job == "-") {
    print_data(job_text(settings, std::filesystem::current_path() / "job.toml"));
    return;
  }
  std::error_code none;
  if (!parsed.force && std::filesystem::exists(*parsed.write_job, none))
    throw Error(ErrorCode::command, parsed.write_job->string(),
                "There is a file of this name; --write-job would overwrite it.",
                "Choose another name, or add --force.");
  if (std::filesystem::equivalent(*parsed.write_job, settings.scene, none))
    throw Error(ErrorCode::command, parsed.write_job->string(),
                "This is the scene itself; --write-job would overwrite it.",
                "Choose another name, such as shot.toml.");
  write_atomically(*parsed.write_job, job_text(settings, *parsed.write_job));
}

int run_bake(const BakeArguments& parsed) {
  BakeSettings settings;
  apply_command_line(parsed, settings);
  settings.log = parsed.log;
  if (!parsed.write_job && !parsed.dry_run)
    require_output(settings, "Write -o DIR, or output = \"DIR\" in the job file.");
  if (parsed.write_job) {
    const BakePlan plan = plan_bake(settings);  // what cannot be baked is not written
    write_job(parsed, settings);
    if (settings.output.empty()) {
      if (*parsed.write_job != "-") list_line(parsed.write_job->string());
      return plan.impossible.empty() ? 0 : gate_missed;
    }
  }

  const BakePlan plan = plan_with_accuracy(settings, [&](const std::string& sentence) {
    Progress(settings.progress, 0, passes_of(settings)).message(sentence);
  });
  if (parsed.dry_run) {
    Progress progress(settings.progress, 0, passes_of(settings));
    print_warnings(plan, progress);
    print_data(lock_text(plan));
    return plan.impossible.empty() ? 0 : gate_missed;
  }
  const BakeOutcome outcome = bake_with_progress(settings, plan, is_stop_asked);
  for (const auto& file : outcome.files) list_line(file.string());
  return outcome.exit_code;
}

}  // namespace

Command bake_command(CLI::App& app) {
  const auto parsed = std::make_shared<BakeArguments>();
  add_bake(app, *parsed);
  return {parsed->command, [=] { return run_bake(*parsed); },
          [] { return std::chrono::milliseconds(850); }};
}

}  // namespace paperbake
