#include "baker/output/say.h"

#include <cstdio>

namespace paperbake {

void say(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

void say_line(const std::string& sentence) { say(sentence + "\n"); }

void list_line(const std::string& line) {
  std::fwrite(line.data(), 1, line.size(), stdout);
  std::fputc('\n', stdout);
}

}  // namespace paperbake
