#include "formats/scene/sandbox.h"

#include "formats/scene/confinement.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace paperbake {
namespace {

constexpr int failed_exit_code = 70;  // when the work throws or its answer cannot be sent

/// grace  added for the hard limit, which the process cannot raise again
void limit(int resource, rlim_t max, rlim_t grace = 0) {
  rlimit now{};
  if (::getrlimit(static_cast<__rlimit_resource_t>(resource), &now) != 0) return;
  now.rlim_cur = std::min(now.rlim_max, max);
  now.rlim_max = std::min(now.rlim_max, max + grace);
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &now);
}

std::uint64_t memory_in_use() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

bool write_all(int to, const char* bytes, std::size_t count) {
  while (count > 0) {
    const ssize_t done = ::write(to, bytes, count);
    if (done < 0 && errno != EINTR) return false;
    if (done > 0) {
      bytes += done;
      count -= static_cast<std::size_t>(done);
    }
  }
  return true;
}

std::string read_all(int from) {
  std::string bytes;
  char part[1 << 16];
  for (ssize_t count; (count = ::read(from, part, sizeof part)) != 0;) {
    if (count < 0 && errno != EINTR) break;
    if (count > 0) bytes.append(part, static_cast<std::size_t>(count));
  }
  return bytes;
}

/// Runs the work in the child process. The answer is preceded by its size, so that the parent can
/// tell when it is cut off.
[[noreturn]] void work_and_end(const std::function<std::string()>& work,
                               const SandboxLimits& limits, int to) {
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU, SIGPIPE})
    std::signal(signal, SIG_DFL);
  // a stop of the program is obeyed by the parent, with which this one ends
  for (const int signal : {SIGTERM, SIGINT}) std::signal(signal, SIG_IGN);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, limits.seconds, 1);  // SIGXCPU comes first, and then SIGKILL
  limit(RLIMIT_AS, memory_in_use() + limits.bytes);
  if (const int nowhere = ::open("/dev/null", O_RDWR); nowhere >= 0) {
    ::dup2(nowhere, STDIN_FILENO);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
  }
  confine_process(limits.readable);
  try {
    const std::string answer = work();
    const std::uint64_t size = answer.size();
    const bool sent = write_all(to, reinterpret_cast<const char*>(&size), sizeof size) &&
                      write_all(to, answer.data(), answer.size());
    ::_exit(sent ? 0 : failed_exit_code);
  } catch (...) {
    ::_exit(failed_exit_code);
  }
}

std::string describe_end(int status, const SandboxLimits& limits) {
  if (!WIFSIGNALED(status)) return "failed";
  const int signal = WTERMSIG(status);
  if (signal == SIGXCPU) return "ran for more than " + std::to_string(limits.seconds) + " s";
  return std::string("crashed (") + ::strsignal(signal) + ")";
}

}  // namespace

SandboxResult run_sandboxed(const std::function<std::string()>& work, const SandboxLimits& limits) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    return {std::nullopt, std::string("could not be started: ") + std::strerror(errno)};
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    work_and_end(work, limits, ends[1]);
  }
  const std::string reason = std::strerror(errno);
  ::close(ends[1]);
  std::string answer = child < 0 ? std::string() : read_all(ends[0]);
  ::close(ends[0]);
  if (child < 0) return {std::nullopt, "could not be started: " + reason};
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  std::uint64_t size = 0;
  if (answer.size() >= sizeof size) std::memcpy(&size, answer.data(), sizeof size);
  if (answer.size() < sizeof size || answer.size() - sizeof size != size)
    return {std::nullopt, describe_end(status, limits)};
  return {answer.substr(sizeof size), ""};
}

}  // namespace paperbake
