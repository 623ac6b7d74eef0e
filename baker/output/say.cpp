#include "baker/output/say.h"

#include "core/model/error.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>

namespace paperbake {

void say(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void say_line(const std::string& sentence) { say(sentence + "\n"); }

void print_data(const std::string& text) {
  const bool is_written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if ((is_written && std::fflush(stdout) == 0) || errno == EPIPE) return;
  throw Error(ErrorCode::folder, "standard output",
              fmt::format("It cannot be written: {}.", std::strerror(errno)),
              "Let it lead to where there is room.");
}

void list_line(const std::string& line) {
  std::fwrite(line.data(), 1, line.size(), stdout);
  std::fputc('\n', stdout);
}

}  // namespace paperbake
