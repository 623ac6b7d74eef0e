#include "baker/job/file_names.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <string_view>

namespace paperbake {
namespace {

/// The first bytes of a UTF-8 text, without half a character at the end.
std::string beginning_of(const std::string& text, std::size_t most) {
  std::size_t end = std::min(text.size(), most);
  while (end > 0 && end < text.size() && (text[end] & 0xC0) == 0x80) --end;
  return text.substr(0, end);
}

std::string legal_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(),
      [](char c) {
        return c == '/' || c == '.' || c == ':' || c == ' ' || (c >= 0 && c < ' ') || c == 127;
      },
      '_');
  constexpr std::size_t most = 80;  // bytes, so that there is room for the name of the shot
  return beginning_of(name, most);
}

/// Labels of the sheets, and with each the number of the sheet that has the plain one.
struct Labels {
  std::vector<std::string> labels;
  std::map<std::string, std::size_t> owner;
};

Labels unique_labels(const std::vector<std::string>& names) {
  Labels found;
  for (std::size_t s = 0; s < names.size(); ++s) {
    const std::string legal = legal_name(names[s]);
    std::string label = legal;
    for (int n = 2; !found.owner.emplace(label, s).second; ++n)
      label = fmt::format("{}_{}", legal, n);
    found.labels.push_back(label);
  }
  return found;
}

}  // namespace

std::string legal_shot_name(std::string name, const std::vector<std::string>& suffixes) {
  constexpr std::size_t most_of_system = 255, ending = std::string_view(".preview.png.part").size();
  std::size_t suffix = 0;
  for (const std::string& s : suffixes) suffix = std::max(suffix, s.size());
  for (char& c : name)
    if ((c >= 0 && c < ' ') || c == 127) c = '_';
  return beginning_of(name, most_of_system - ending - suffix);
}

std::vector<std::string> sheet_file_suffixes(const std::vector<std::string>& names) {
  if (names.size() < 2) return std::vector<std::string>(names.size());
  std::vector<std::string> suffixes;
  for (const std::string& label : unique_labels(names).labels) suffixes.push_back("." + label);
  return suffixes;
}

std::vector<std::string> describe_shared_names(const std::vector<std::string>& names) {
  std::vector<std::string> sentences;
  const Labels all = unique_labels(names);
  for (std::size_t s = 0; s < names.size(); ++s)
    if (const std::string legal = legal_name(names[s]); all.labels[s] != legal)
      sentences.push_back(
          fmt::format("The files of sheet \"{}\" would have the names of those of sheet \"{}\": "
                      "they have \"{}\" "
                      "in their names instead.",
                      names[s], names[all.owner.at(legal)], all.labels[s]));
  return sentences;
}

}  // namespace paperbake
