#include "baker/studies/wedge_axes.h"

#include "baker/job/options.h"
#include "core/model/error.h"
#include "formats/config/nearest_word.h"
#include "formats/config/preset_file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace paperbake {
namespace {

constexpr int max_variations = 10000;

/// Options that say nothing of the sheet, or where its files go: the wedge has one of each.
const std::vector<std::string> shared{"output", "formats", "debug_pictures", "threads", "progress"};

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find(at, from), text.size());
    parts.push_back(text.substr(from, end - from));
    from = end + 1;
  }
  return parts;
}

std::optional<double> number_in(const std::string& text) {
  const auto value = canonical({"", JobKey::number}, text);
  return value ? std::optional(std::stod(*value)) : std::nullopt;
}

/// A..B or A..BxSTEP as its values; another text as itself.
std::vector<std::string> values_in(const std::string& text, const std::string& place) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) return {text};
  const std::string rest = text.substr(dots + 2);
  const std::size_t by = rest.find('x');
  const auto first = number_in(text.substr(0, dots)), last = number_in(rest.substr(0, by));
  const auto step = by == std::string::npos ? 1.0 : number_in(rest.substr(by + 1));
  if (!first || !last) return {text};  // a file name, ../my.toml
  if (!step || *step <= 0 || *last < *first)
    throw Error(ErrorCode::command, place, fmt::format("\"{}\" is no range.", text),
                "Write A..B or A..BxSTEP, for instance 1..16 or 0..10x2.5.");
  const double steps = std::floor((*last - *first) / *step * (1 + 1e-12) + 1e-9);
  if (steps >= max_variations)
    throw Error(ErrorCode::command, place,
                fmt::format("\"{}\" has more than {} values.", text, max_variations),
                "Write a larger step: A..BxSTEP.");
  std::vector<std::string> values;
  for (int k = 0; k <= steps; ++k) values.push_back(fmt::format("{:.12g}", *first + k * *step));
  return values;
}

std::vector<std::string> all_keys() {
  std::vector<std::string> keys;
  for (const Option& o : options())
    if (std::find(shared.begin(), shared.end(), o.name) == shared.end()) keys.push_back(o.name);
  for (const PaperParameter& parameter : paper_parameters) keys.push_back(parameter.key);
  return keys;
}

void apply(BakeSettings& settings, const Axis& axis, const std::string& value) {
  if (axis.of_paper)
    settings.set.push_back(parse_set(axis.key + "=" + value));
  else
    apply_option(settings, option(axis.key), value, "--vary " + axis.key, Origin::command);
}

/// The value as the key has it. throws Error(ErrorCode::command) when it may not
std::string checked(const Axis& axis, const std::string& text) {
  const std::string place = "--vary " + axis.key;
  const JobKey key = axis.of_paper ? JobKey{axis.key, JobKey::number} : JobKey(option(axis.key));
  const auto value = canonical(key, text);
  if (!value)
    throw Error(ErrorCode::command, place, fmt::format("\"{}\" is not {}.", text, expected(key)));
  BakeSettings scratch;
  try {
    apply(scratch, axis, *value);
  } catch (const Error& error) {
    throw Error(error.code, place, error.cause, error.remedy);
  }
  if (axis.key == "preset") read_preset(text);  // an unknown one is said before anything is baked
  return *value;
}

}  // namespace

Axis parse_axis(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw Error(
        ErrorCode::command, "--vary " + text, "A key and its values are needed.",
        "Write --vary key=values, for instance --vary seed=1..16 or --vary preset=copy70,copy90.");
  Axis axis;
  axis.key = text.substr(0, equals);
  std::replace(axis.key.begin(), axis.key.end(), '-', '_');
  const std::string place = "--vary " + axis.key;
  if (std::find(shared.begin(), shared.end(), axis.key) != shared.end())
    throw Error(ErrorCode::command, place, "All variations have this in common.",
                fmt::format("Say it once, with --{}.",
                            axis.key == "debug_pictures" ? "debug-pictures" : axis.key));
  const std::vector<std::string> keys = all_keys();
  if (std::find(keys.begin(), keys.end(), axis.key) == keys.end())
    throw Error(ErrorCode::command, place,
                fmt::format("Unknown key \"{}\".{}", axis.key, did_you_mean(axis.key, keys)),
                fmt::format("The keys are: {}.", fmt::join(keys, ", ")));
  axis.of_paper = std::none_of(options().begin(), options().end(),
                               [&](const Option& o) { return o.name == axis.key; });
  axis.number = axis.of_paper || option(axis.key).kind == JobKey::number ||
                option(axis.key).kind == JobKey::whole;
  for (const std::string& part : split(text.substr(equals + 1), ','))
    for (const std::string& value : values_in(part, place))
      axis.values.push_back(checked(axis, value));
  return axis;
}

std::vector<Axis> parse_axes(const std::vector<std::string>& texts) {
  std::vector<Axis> axes;
  double count = 1;
  for (const std::string& text : texts) {
    Axis axis = parse_axis(text);
    if (std::any_of(axes.begin(), axes.end(), [&](const Axis& a) { return a.key == axis.key; }))
      throw Error(ErrorCode::command, "--vary " + axis.key, "It is varied twice.",
                  fmt::format("Write all its values behind one --vary {}=, separated by commas.",
                              axis.key));
    count *= axis.values.size();
    axes.push_back(std::move(axis));
  }
  if (count > max_variations)
    throw Error(ErrorCode::command, "--vary",
                fmt::format("That makes {:g} variations; {} is the most.", count, max_variations),
                "Vary fewer keys, or give them fewer values.");
  return axes;
}

int variations(const std::vector<Axis>& axes) {
  int count = 1;
  for (const Axis& axis : axes) count *= static_cast<int>(axis.values.size());
  return count;
}

std::vector<std::string> values_of(const std::vector<Axis>& axes, int index) {
  std::vector<std::string> values(axes.size());
  int rest = index - 1;
  for (std::size_t k = axes.size(); k-- > 0; rest /= static_cast<int>(axes[k].values.size()))
    values[k] = axes[k].values[rest % axes[k].values.size()];
  return values;
}

BakeSettings varied(BakeSettings settings, const std::vector<Axis>& axes, int index) {
  const std::vector<std::string> values = values_of(axes, index);
  for (std::size_t k = 0; k < axes.size(); ++k) apply(settings, axes[k], values[k]);
  return settings;
}

}  // namespace paperbake
