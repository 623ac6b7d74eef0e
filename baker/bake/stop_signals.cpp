#include "baker/bake/stop_signals.h"

#include "baker/output/progress.h"
#include "baker/output/say.h"
#include "core/model/error.h"
#include "formats/files/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <poll.h>
#include <thread>
#include <unistd.h>

namespace paperbake {
namespace {

std::atomic<bool> stop_asked = false;  // set by a signal handler, read by all threads
static_assert(std::atomic<bool>::is_always_lock_free);
int signal_pipe[2] = {-1, -1};  // a byte for every signal

void note_signal(int) {
  const int error = errno;
  stop_asked = true;
  const char byte = 0;
  // the pipe can only be full when it has been told often enough
  if (::write(signal_pipe[1], &byte, 1) < 0) errno = error;
  errno = error;
}

/// Waits for the next signal. timeout_ms: -1: for ever
void wait_for_signal(int timeout_ms) {
  pollfd waiting{signal_pipe[0], POLLIN, 0};
  while (::poll(&waiting, 1, timeout_ms) < 0 && errno == EINTR) {
  }
  char byte;
  if (waiting.revents & POLLIN) {
    while (::read(signal_pipe[0], &byte, 1) < 0 && errno == EINTR) {
    }
  }
}

[[noreturn]] void end_at_once() {
  delete_unfinished_files();
  constexpr const char* cause = "The program was stopped in the middle of its work.";
  Error stopped(ErrorCode::stopped, "stopped", cause,
                "What was done until then is kept: the same command continues from there.");
  if (!Progress::end_abruptly(stopped))
    stopped = Error(ErrorCode::stopped, "stopped", cause,
                    "What is complete is kept: the same command does the rest.");
  say_line(std::string("\npaperbake: ") + stopped.what());
  ::_exit(static_cast<int>(stopped.code));
}

}  // namespace

StopSignals::StopSignals(std::chrono::milliseconds patience) {
  if (::pipe2(signal_pipe, O_CLOEXEC) != 0) return;  // then a signal ends it as usual
  std::thread([patience] {
    wait_for_signal(-1);
    wait_for_signal(static_cast<int>(patience.count()));
    end_at_once();
  }).detach();
  struct sigaction action {};
  action.sa_handler = note_signal;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) ::sigaction(signal, &action, nullptr);
}

bool StopSignals::asked() { return stop_asked != 0; }

}  // namespace paperbake
