#include "plumbline/apps/benchmark/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

namespace plumbline {
namespace {

using testing::HasSubstr;

TEST(ChildProcessTest, HandsBackTextOfAnyLengthAndContent) {
  std::string result = "old";
  ASSERT_TRUE(RunInChild([] { return std::string(); }, &result).ok());
  EXPECT_EQ(result, "");
  // More than a pipe holds.
  std::string text(3000000, 'x');
  text[1] = '\0';
  ASSERT_TRUE(RunInChild([&] { return text; }, &result).ok());
  EXPECT_TRUE(result == text);
}

TEST(ChildProcessTest, TheCallersMemoryStaysAsItIs) {
  int value = 1;
  std::string result;
  const auto work = [&] {
    value = 2;
    return std::to_string(value) + ' ' + std::to_string(getpid());
  };
  ASSERT_TRUE(RunInChild(work, &result).ok());
  EXPECT_EQ(value, 1);
  EXPECT_EQ(result.substr(0, 2), "2 ");
  EXPECT_NE(result.substr(2), std::to_string(getpid()));
}

TEST(ChildProcessTest, ABadEndIsReported) {
  std::string result = "old";
  const auto killed = [] {
    std::raise(SIGKILL);
    return std::string("new");
  };
  Status status = RunInChild(killed, &result);
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("signal 9 (Killed)"));
  const auto exits = []() -> std::string { _exit(3); };
  status = RunInChild(exits, &result);
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("exit code 3"));
  EXPECT_EQ(result, "old");
  // And the next one is none the worse for it.
  ASSERT_TRUE(RunInChild([] { return std::string("new"); }, &result).ok());
  EXPECT_EQ(result, "new");
}

}  // namespace
}  // namespace plumbline
