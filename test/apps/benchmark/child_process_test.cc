#include "plumbline/apps/benchmark/child_process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>
#include <sys/wait.h>
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

// The moment between fork and the child's first line.
bool signal_after_fork = false;
void RaiseIfAsked() {
  if (signal_after_fork) std::raise(SIGTERM);
}

TEST(ChildProcessTest, NoHandlerOfTheParentRunsInTheChild) {
  ASSERT_EQ(pthread_atfork(nullptr, nullptr, RaiseIfAsked), 0);
  const auto handler_before = std::signal(SIGTERM, [](int) { _exit(77); });
  signal_after_fork = true;
  std::string result;
  const Status status = RunInChild([] { return std::string("new"); }, &result);
  signal_after_fork = false;
  // The child's end of it is over; the parent's is as it was.
  EXPECT_THAT(status.message(), HasSubstr("signal 15"));
  sigset_t blocked;
  pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
  EXPECT_EQ(sigismember(&blocked, SIGTERM), 0);
  EXPECT_EXIT(std::raise(SIGTERM), testing::ExitedWithCode(77), "");
  std::signal(SIGTERM, handler_before);
}

// By a stop signal too, which only the parent answers.
TEST(ChildProcessTest, EndsWithItsParent) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    std::string result;
    const auto work = [&ends]() -> std::string {
      const pid_t child = getpid();
      if (write(ends[1], &child, sizeof(child)) != sizeof(child)) _exit(1);
      while (true) pause();
    };
    _exit(RunInChild(work, &result).ok() ? 0 : 1);
  }
  close(ends[1]);
  pid_t child = 0;
  ASSERT_EQ(read(ends[0], &child, sizeof(child)), static_cast<ssize_t>(sizeof(child)));
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  // Nobody holds the other end any more, or the child is still there.
  constexpr int kPatienceMs = 10000;
  pollfd end{ends[0], POLLIN, 0};
  EXPECT_EQ(poll(&end, 1, kPatienceMs), 1);
  kill(child, SIGKILL);
  close(ends[0]);
}

}  // namespace
}  // namespace plumbline
