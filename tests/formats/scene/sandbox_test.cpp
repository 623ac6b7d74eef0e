// Work in a sandboxed process: what it returns, and how its failures are reported.

#include "formats/scene/sandbox.h"

#include "tests/own_folder.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace paperbake {
namespace {

const SandboxLimits usual{std::uint64_t(1) << 30, 10};

SandboxResult run(const std::function<std::string()>& work) { return run_sandboxed(work, usual); }

TEST(Sandbox, ReturnsAllBytes) {
  std::string all;
  // many times the capacity of a pipe
  for (unsigned i = 0; i < 3000000; ++i) all += static_cast<char>(i * i % 251);
  EXPECT_EQ(run([&] { return all; }).bytes, all);
  EXPECT_EQ(run([] { return std::string(); }).bytes, "");
}

TEST(Sandbox, DoesNotChangeThisProcess) {
  int touched = 0;
  run([&] {
    ++touched;
    return std::string();
  });
  EXPECT_EQ(touched, 0);
}

TEST(Sandbox, ReportsHowTheWorkEndedWhenItFailed) {
  const SandboxResult crashed = run([]() -> std::string {
    std::raise(SIGSEGV);
    return "after";
  });
  EXPECT_FALSE(crashed.bytes);
  EXPECT_EQ(crashed.ended, "crashed (Segmentation fault)");
  const SandboxResult threw = run([]() -> std::string { throw std::runtime_error("foreign"); });
  EXPECT_FALSE(threw.bytes);
  EXPECT_EQ(threw.ended, "failed");
  // exit code 0 without an answer is a failure
  const SandboxResult left = run([]() -> std::string { std::_Exit(0); });
  EXPECT_FALSE(left.bytes);
}

TEST(Sandbox, EndsWorkThatExceedsItsLimits) {
  const SandboxResult endless = run_sandboxed(
      []() -> std::string {
        for (volatile bool on = true; on;) {
        }
        return "";
      },
      {std::uint64_t(1) << 30, 1});
  EXPECT_FALSE(endless.bytes);
  EXPECT_EQ(endless.ended, "ran for more than 1 s");
  const auto greedy = [](std::size_t megabytes) {
    return [megabytes] {
      return std::string(std::vector<char>(megabytes << 20, 'x').back() == 'x' ? "had" : "");
    };
  };
  EXPECT_FALSE(run_sandboxed(greedy(600), {std::uint64_t(300) << 20, 10}).bytes);
  EXPECT_EQ(run_sandboxed(greedy(100), {std::uint64_t(300) << 20, 10}).bytes, "had");
}

/// What an attempt does in a sandboxed process that may read one folder.
int error_of_attempt(const std::function<long()>& attempt, const std::filesystem::path& readable) {
  SandboxLimits limits = usual;
  limits.readable = {readable};
  const SandboxResult result = run_sandboxed(
      [&] {
        errno = 0;
        return std::to_string(attempt() < 0 ? errno : 0);
      },
      limits);
  return result.bytes ? std::stoi(*result.bytes) : -1;
}

TEST(Sandbox, CannotWriteConnectOrStartAnything) {
  const std::filesystem::path folder = test::own_folder() / "readable";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "part.bin") << "bytes";
  std::ofstream(test::own_folder() / "beside.bin") << "secret";
  const std::string inside = folder / "part.bin", outside = test::own_folder() / "beside.bin";
  const auto of = [&](const std::function<long()>& attempt) {
    return error_of_attempt(attempt, folder);
  };
  EXPECT_EQ(of([&] { return open(inside.c_str(), O_RDONLY); }), 0);
  EXPECT_EQ(of([&] { return open(inside.c_str(), O_WRONLY); }), EPERM);
  EXPECT_EQ(of([&] { return open((folder / "new").c_str(), O_RDONLY | O_CREAT, 0666); }), EPERM);
  EXPECT_EQ(of([&] { return unlink(inside.c_str()); }), EPERM);
  EXPECT_EQ(of([&] { return rename(inside.c_str(), outside.c_str()); }), EPERM);
  EXPECT_EQ(of([] { return socket(AF_INET, SOCK_STREAM, 0); }), EPERM);
  EXPECT_EQ(of([] { return socket(AF_UNIX, SOCK_STREAM, 0); }), EPERM);
  EXPECT_EQ(of([] { return fork(); }), EPERM);
  EXPECT_EQ(of([] { return execl("/bin/true", "true", nullptr); }), EPERM);
  EXPECT_EQ(of([] { return kill(getppid(), 0); }), EPERM);
  if (syscall(SYS_landlock_create_ruleset, nullptr, 0, 1) > 0) {
    EXPECT_EQ(of([&] { return open(outside.c_str(), O_RDONLY); }), EACCES);
  }
  EXPECT_EQ(run([&] { return std::to_string(open(outside.c_str(), O_RDONLY) >= 0); }).bytes, "1")
      << "without a folder everything may be read";
}

TEST(Sandbox, AllowsNoSystemCallThatChangesAnythingOutsideIt) {
  const std::filesystem::path folder = test::own_folder();
  std::ofstream(folder / "a") << "bytes";
  const std::string a = folder / "a", b = folder / "b";
  siginfo_t info{};
  const rlimit high{RLIM_INFINITY, RLIM_INFINITY};
  const pid_t parent = getpid();
  // calls that libc does not make, or makes under another number
  const std::vector<std::pair<const char*, std::function<long()>>> calls = {
      {"renameat", [&] { return syscall(SYS_renameat, AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str()); }},
      {"fchmodat2", [&] { return syscall(452, AT_FDCWD, a.c_str(), 0777, 0); }},
      {"rt_sigqueueinfo", [&] { return syscall(SYS_rt_sigqueueinfo, parent, 0, &info); }},
      {"tgkill", [&] { return syscall(SYS_tgkill, parent, parent, 0); }},
      {"pidfd_open", [&] { return syscall(434, parent, 0); }},
      {"prlimit64", [&] { return syscall(SYS_prlimit64, 0, RLIMIT_CPU, &high, nullptr); }},
      {"fcntl", [&] { return syscall(SYS_fcntl, 0, F_SETOWN, parent); }},
      {"ioctl", [] { return syscall(SYS_ioctl, 0, 0x5412, ""); }},
      {"setpriority", [&] { return syscall(SYS_setpriority, 0, parent, 19); }},
      {"mq_open", [] { return syscall(SYS_mq_open, "q", O_CREAT, 0600, nullptr); }},
      {"a call of later kernels", [] { return syscall(9999); }}};
  for (const auto& [name, attempt] : calls)
    EXPECT_EQ(error_of_attempt(attempt, folder), EPERM) << name;
}

}  // namespace
}  // namespace paperbake
