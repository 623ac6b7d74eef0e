// Work in a sandboxed process: what it returns, and how its failures are reported.

#include "formats/scene/sandbox.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace paperbake {
namespace {

TEST(Sandbox, ReturnsAllBytes) {
  std::string all;
  // many times the capacity of a pipe
  for (unsigned i = 0; i < 3000000; ++i) all += static_cast<char>(i * i % 251);
  EXPECT_EQ(run_sandboxed([&] { return all; }).bytes, all);
  EXPECT_EQ(run_sandboxed([] { return std::string(); }).bytes, "");
}

TEST(Sandbox, DoesNotChangeThisProcess) {
  int touched = 0;
  run_sandboxed([&] {
    ++touched;
    return std::string();
  });
  EXPECT_EQ(touched, 0);
}

TEST(Sandbox, ReportsHowTheWorkEndedWhenItFailed) {
  const SandboxResult crashed = run_sandboxed([]() -> std::string {
    std::raise(SIGSEGV);
    return "after";
  });
  EXPECT_FALSE(crashed.bytes);
  EXPECT_EQ(crashed.ended, "crashed (Segmentation fault)");
  const SandboxResult threw =
      run_sandboxed([]() -> std::string { throw std::runtime_error("foreign"); });
  EXPECT_FALSE(threw.bytes);
  EXPECT_EQ(threw.ended, "failed");
  // exit code 0 without an answer is a failure
  const SandboxResult left = run_sandboxed([]() -> std::string { std::_Exit(0); });
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

}  // namespace
}  // namespace paperbake
