#include "baker/check/error_estimate.h"
#include "baker/check/verify.h"
#include "baker/command_line/command.h"
#include "baker/command_line/parsed_options.h"
#include "baker/output/say.h"
#include "core/model/error.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace paperbake {
namespace {

struct VerifyArguments {
  std::filesystem::path folder;
  bool json = false, estimate = false;
};

CLI::App* add_verify(CLI::App& app, VerifyArguments& parsed) {
  CLI::App& verify = *app.add_subcommand(
      "verify", "Compare a baked folder with its certificate, from the files alone");
  verify.add_option("DIR", parsed.folder, "The output folder of a bake")->required();
  verify.add_flag("--json", parsed.json, "Print JSON");
  verify.add_flag("--estimate", parsed.estimate,
                  "Estimate the error of every 12th frame: how far it moves when a finer mesh "
                  "continues from it. For sheets at rest: none of those that move with inertia");
  return &verify;
}

int run_verify(const VerifyArguments& parsed) {
  const Verification verification = verify(parsed.folder);
  std::optional<ErrorEstimates> estimates;
  if (parsed.estimate) estimates = estimate_errors(parsed.folder);
  if (parsed.json) {
    print_data(verification_json(verification, estimates));
  } else {
    print_data(verification_text(parsed.folder, verification));
    if (estimates) print_data(estimates_text(*estimates));
  }
  return verification.differences.empty() ? 0 : gate_missed;
}

}  // namespace

Command verify_command(CLI::App& app) {
  const auto parsed = std::make_shared<VerifyArguments>();
  CLI::App* const command = add_verify(app, *parsed);
  return {command, [=] { return run_verify(*parsed); }};
}

}  // namespace paperbake
