// Work in a process of its own: what comes back, and how it ends where it does not come to its end.

#include "formats/scene/sandbox.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

namespace paperbake {
namespace {

TEST(Apart, HandsBackAllBytes) {
  std::string all;
  // many times what a pipe holds
  for (unsigned i = 0; i < 3000000; ++i) all += static_cast<char>(i * i % 251);
  EXPECT_EQ(run_apart([&] { return all; }).bytes, all);
  EXPECT_EQ(run_apart([] { return std::string(); }).bytes, "");
}

TEST(Apart, LeavesThisProcessAsItIs) {
  int touched = 0;
  run_apart([&] { return ++touched, std::string(); });
  EXPECT_EQ(touched, 0);
}

TEST(Apart, SaysHowItEndedWhenItDidNotComeToItsEnd) {
  const Apart crashed = run_apart([]() -> std::string {
    std::raise(SIGSEGV);
    return "after";
  });
  EXPECT_FALSE(crashed.bytes);
  EXPECT_EQ(crashed.ended, "crashed (Segmentation fault)");
  const Apart threw = run_apart([]() -> std::string { throw std::runtime_error("foreign"); });
  EXPECT_FALSE(threw.bytes);
  EXPECT_EQ(threw.ended, "broke off");
  // a good end without an answer is none
  const Apart left = run_apart([]() -> std::string { std::_Exit(0); });
  EXPECT_FALSE(left.bytes);
}

TEST(Apart, EndsWorkThatTakesTooMuch) {
  const Apart endless = run_apart(
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
  EXPECT_FALSE(run_apart(greedy(600), {std::uint64_t(300) << 20, 10}).bytes);
  EXPECT_EQ(run_apart(greedy(100), {std::uint64_t(300) << 20, 10}).bytes, "had");
}

}  // namespace
}  // namespace paperbake
