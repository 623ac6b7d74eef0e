#include "baker/command_line/command_line.h"
#include "baker/output/say.h"
#include "core/model/error.h"

#include <csignal>
#include <exception>
#include <fcntl.h>
#include <malloc.h>
#include <string>
#include <unistd.h>

/// A stream that the caller has closed leads to nowhere: otherwise the next file that is opened
/// would get its number, and messages would be written into it.
static void open_standard_streams() {
  int opened;
  do opened = ::open("/dev/null", O_RDWR);
  while (opened >= 0 && opened <= STDERR_FILENO);
  if (opened >= 0) ::close(opened);
}

int main(int argc, char** argv) {
  open_standard_streams();
  // factors come and go by the megabyte: keep their memory instead of asking the kernel for zeroed
  // pages every time
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
  // a file that may grow no more is an error like a full disk, not the end
  std::signal(SIGXFSZ, SIG_IGN);
  // and so is a pipe that nobody reads any more
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return paperbake::run_command_line({argv + 1, argv + argc});
  } catch (const paperbake::Error& error) {
    paperbake::say_line(std::string("paperbake: ") + error.what());
    return static_cast<int>(error.code);
  } catch (const std::exception& error) {
    paperbake::say_line(std::string("paperbake: ") + error.what());
    return static_cast<int>(paperbake::ErrorCode::simulation);
  }
}
