#include "formats/scene/confinement.h"

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <vector>

namespace paperbake {
namespace {

#if defined(__x86_64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t architecture = 0;  // not known: nothing is filtered
#endif

/// The system calls that are allowed: what reading files, computing and answering take. Whatever a
/// kernel has besides is refused, calls that do not exist yet among it.
const std::vector<long> allowed = {
#if defined(__x86_64__)
    SYS_stat, SYS_lstat, SYS_access, SYS_readlink, SYS_getdents, SYS_poll, SYS_arch_prctl,
#endif
    // files that are open, or are opened for reading (see writing_flags)
    SYS_read, SYS_readv, SYS_pread64, SYS_preadv, SYS_write, SYS_writev, SYS_lseek, SYS_close,
    SYS_dup, SYS_fstat, SYS_newfstatat, SYS_statx, SYS_faccessat, SYS_readlinkat, SYS_getdents64,
    SYS_getcwd, SYS_fadvise64, SYS_ppoll,
#ifdef SYS_faccessat2  // from Linux 5.8
    SYS_faccessat2,
#endif
    // memory
    SYS_brk, SYS_mmap, SYS_munmap, SYS_mremap, SYS_mprotect, SYS_madvise,
    // this process: its end, signals, locks, clocks
    SYS_exit, SYS_exit_group, SYS_rt_sigaction, SYS_rt_sigprocmask, SYS_rt_sigreturn,
    SYS_sigaltstack, SYS_restart_syscall, SYS_futex, SYS_sched_yield, SYS_sched_getaffinity,
    SYS_nanosleep, SYS_clock_nanosleep, SYS_clock_gettime, SYS_gettimeofday, SYS_getrandom,
    SYS_getpid, SYS_getppid, SYS_gettid, SYS_getuid, SYS_geteuid, SYS_getgid, SYS_getegid,
    SYS_getrlimit, SYS_getrusage, SYS_times, SYS_uname, SYS_sysinfo};

constexpr std::uint32_t writing_flags =
    O_WRONLY | O_RDWR | O_CREAT | O_TRUNC | O_APPEND;  // of open() and openat()

using Filter = std::vector<sock_filter>;

void answer(Filter& filter, std::uint32_t verdict) {
  filter.push_back(BPF_STMT(BPF_RET | BPF_K, verdict));
}
constexpr std::uint32_t refused = SECCOMP_RET_ERRNO | EPERM;

/// Decides on one call: `rules` see the lower half of one of its arguments and must return.
void decide(Filter& filter, long call, int argument, const Filter& rules) {
  // on little-endian processors
  const auto at = static_cast<std::uint32_t>(offsetof(seccomp_data, args) + 8 * argument);
  filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0,
                            static_cast<std::uint8_t>(rules.size() + 1)));
  filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, at));
  filter.insert(filter.end(), rules.begin(), rules.end());
}

Filter unless_any_of(std::uint32_t bits) {
  Filter rules{BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, bits, 0, 1)};
  answer(rules, refused);
  answer(rules, SECCOMP_RET_ALLOW);
  return rules;
}

Filter if_one_of(const std::vector<std::uint32_t>& values) {
  Filter rules;
  for (const std::uint32_t value : values) {
    rules.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, 0, 1));
    answer(rules, SECCOMP_RET_ALLOW);
  }
  answer(rules, refused);
  return rules;
}

void filter_system_calls() {
  if (architecture == 0) return;
  Filter filter{BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch)),
                BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, architecture, 1, 0)};
  answer(filter, refused);
  filter.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)));
#if defined(__x86_64__)
  decide(filter, SYS_open, 1, unless_any_of(writing_flags));
#endif
  decide(filter, SYS_openat, 2, unless_any_of(writing_flags));
  // what streams ask of files, and not who gets signals about them
  decide(filter, SYS_fcntl, 1, if_one_of({F_GETFD, F_SETFD, F_GETFL, F_DUPFD, F_DUPFD_CLOEXEC}));
  // abort() and raise() send a signal to this process
  decide(filter, SYS_tgkill, 0, if_one_of({static_cast<std::uint32_t>(::getpid())}));
  for (const long call : allowed) {
    filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(call), 0, 1));
    answer(filter, SECCOMP_RET_ALLOW);
  }
  answer(filter, refused);
  const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
  ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program);
}

void read_only_below(const std::vector<std::filesystem::path>& folders) {
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR |
                              LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_EXECUTE;
  const auto rules =
      static_cast<int>(::syscall(SYS_landlock_create_ruleset, &handled, sizeof handled, 0));
  if (rules < 0) return;
  bool complete = true;
  for (const std::filesystem::path& folder : folders) {
    const int at = ::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC);
    landlock_path_beneath_attr below{};
    below.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;
    below.parent_fd = at;
    complete &= at >= 0 &&
                ::syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &below, 0) == 0;
    if (at >= 0) ::close(at);
  }
  if (complete) ::syscall(SYS_landlock_restrict_self, rules, 0);
  ::close(rules);
}

}  // namespace

void confine_process(const std::vector<std::filesystem::path>& readable) {
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return;
  if (!readable.empty()) read_only_below(readable);
  filter_system_calls();
}

}  // namespace paperbake
