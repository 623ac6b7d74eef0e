#include "baker/output/write_failures.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {

bool Losses::attempt(const std::string& file, const std::function<void()>& write) {
  if (find(file)) return false;
  try {
    write();
    return true;
  } catch (const Error& error) {
    all_.push_back({file, error});
  } catch (const std::exception& error) {  // of a library
    all_.push_back({file, Error(Fault::simulation, file,
                                fmt::format("It cannot be made: {}.", error.what()))});
  }
  return false;
}

void Losses::kept(const std::string& file, const std::string& how_much, const Error& error) {
  if (!find(file)) all_.push_back({file, error});
  find(file)->kept = how_much;
}

std::string Losses::sentence() const {
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t k = 0; k < std::min(most, all_.size()); ++k)
    text += (k ? "; " : "") + (all_[k].kept.empty() ? "there is no " + all_[k].file
                                                    : all_[k].file + " " + all_[k].kept);
  if (all_.size() > most) text += fmt::format("; and {} more are not there", all_.size() - most);
  return text;
}

Loss* Losses::find(const std::string& file) {
  const auto found =
      std::find_if(all_.begin(), all_.end(), [&](const Loss& loss) { return loss.file == file; });
  return found == all_.end() ? nullptr : &*found;
}

}  // namespace paperbake
