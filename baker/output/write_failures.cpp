#include "baker/output/write_failures.h"

#include <algorithm>
#include <fmt/format.h>

namespace paperbake {

bool WriteFailures::try_write(const std::string& file, const std::function<void()>& write) {
  if (find(file)) return false;
  try {
    write();
    return true;
  } catch (const Error& error) {
    all_.push_back({file, error});
  } catch (const std::exception& error) {  // of a library
    all_.push_back({file, Error(ErrorCode::simulation, file,
                                fmt::format("It cannot be made: {}.", error.what()))});
  }
  return false;
}

void WriteFailures::record_partial(const std::string& file, const std::string& how_much,
                                   const Error& error) {
  if (!find(file)) all_.push_back({file, error});
  find(file)->partial = how_much;
}

std::string WriteFailures::summary() const {
  constexpr std::size_t max_listed = 3;
  std::string text;
  for (std::size_t k = 0; k < std::min(max_listed, all_.size()); ++k)
    text += (k ? "; " : "") + (all_[k].partial.empty() ? "there is no " + all_[k].file
                                                       : all_[k].file + " " + all_[k].partial);
  if (all_.size() > max_listed)
    text += fmt::format("; and {} more are not there", all_.size() - max_listed);
  return text;
}

WriteFailure* WriteFailures::find(const std::string& file) {
  const auto found = std::find_if(
      all_.begin(), all_.end(), [&](const WriteFailure& failure) { return failure.file == file; });
  return found == all_.end() ? nullptr : &*found;
}

}  // namespace paperbake
