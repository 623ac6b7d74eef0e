#include "baker/studies/child_processes.h"

#include "core/model/error.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <map>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace paperbake {
namespace {

/// The end of a child, which run_processes waits for; its signal is blocked while this lives.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGCHLD);
    sigprocmask(SIG_BLOCK, &set_, &before_);
  }
  ~BlockedSignals() { restore(); }
  void restore() const { sigprocmask(SIG_SETMASK, &before_, nullptr); }
  /// Waits for a moment.
  void wait() const {
    const timespec moment{0, 50'000'000};
    sigtimedwait(&set_, nullptr, &moment);
  }

 private:
  sigset_t set_, before_;
};

/// The variables of this process; but a bake uses one thread of OpenBLAS, and more would spin for a
/// while.
std::vector<char*> environment_of_bakes() {
  static char one_thread[] = "OPENBLAS_NUM_THREADS=1";
  const std::size_t name = std::strchr(one_thread, '=') - one_thread + 1;
  std::vector<char*> variables{one_thread};
  for (char** variable = environ; *variable; ++variable)
    if (std::strncmp(*variable, one_thread, name) != 0) variables.push_back(*variable);
  variables.push_back(nullptr);
  return variables;
}

pid_t start(const std::string& program, const ProcessSpec& process, const BlockedSignals& signals) {
  // all that takes memory comes before the fork: another thread may hold the lock of the heap
  const std::vector<char*> environment = environment_of_bakes();
  std::vector<char*> arguments{const_cast<char*>(program.c_str())};
  for (const std::string& argument : process.arguments)
    arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = getpid(), pid = fork();
  if (pid < 0)
    throw Error(ErrorCode::folder, program,
                std::string("It cannot be started: ") + std::strerror(errno) + ".",
                "Ask for fewer at a time with --jobs.");
  if (pid > 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(128 + SIGTERM);
  signals.restore();
  const int log = open(process.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW, 0666),
            nothing = open("/dev/null", O_RDONLY);
  dup2(nothing, STDIN_FILENO);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  execve(program.c_str(), arguments.data(), environment.data());
  _exit(127);
}

}  // namespace

std::filesystem::path this_program() {
  std::error_code failed;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (failed)
    throw Error(ErrorCode::folder, "/proc/self/exe",
                "The system does not tell where this program lies: " + failed.message() + ".");
  return program;
}

bool run_processes(const std::vector<ProcessSpec>& processes, int max_running,
                   const std::function<void(std::size_t)>& started,
                   const std::function<void(std::size_t, int)>& ended,
                   const std::function<bool()>& stop) {
  const std::string program = this_program();
  const BlockedSignals signals;
  std::map<pid_t, std::size_t> running;
  std::size_t next = 0;
  bool interrupted = false;
  while (!running.empty() || (next < processes.size() && !interrupted)) {
    for (;
         next < processes.size() && static_cast<int>(running.size()) < max_running && !interrupted;
         ++next) {
      running[start(program, processes[next], signals)] = next;
      started(next);
    }
    signals.wait();
    if (!interrupted && stop()) {
      interrupted = true;
      for (const auto& [pid, number] : running) kill(pid, SIGTERM);
    }
    for (auto at = running.begin(); at != running.end();) {
      int status = 0;
      if (waitpid(at->first, &status, WNOHANG) != at->first) {
        ++at;
        continue;
      }
      const std::size_t number = at->second;
      at = running.erase(at);
      if (!interrupted)
        ended(number, WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
    }
  }
  return interrupted;
}

}  // namespace paperbake
