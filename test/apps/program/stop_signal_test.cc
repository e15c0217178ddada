#include "plumbline/apps/program/stop_signal.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <iostream>

namespace plumbline {
namespace {

// Signals are for the whole process: every test has one of its own.
class StopSignalTest : public testing::Test {
 protected:
  StopSignalTest() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

[[noreturn]] void ExitAsTold(int exit_code) {
  std::cerr << '[' << StopSignalName() << ']';
  std::exit(ExitCodeAfterStop(exit_code));
}

TEST_F(StopSignalTest, NothingHappensWithoutASignal) {
  const auto run = [] {
    CatchSignals();
    ExitAsTold(StopSignal() + 3);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(3), "\\[\\]");
}

TEST_F(StopSignalTest, TheFirstSignalIsKept) {
  const auto run = [](int number) {
    CatchSignals();
    if (!StoppedDuring("reading").ok()) std::exit(1);
    raise(number);
    std::cerr << StoppedDuring("reading").message();
    ExitAsTold(0);
  };
  EXPECT_EXIT(run(SIGINT), testing::ExitedWithCode(130),
              "stopped by SIGINT during reading: nothing to write\\[SIGINT\\]");
  EXPECT_EXIT(run(SIGTERM), testing::ExitedWithCode(143), "by SIGTERM.*\\[SIGTERM\\]");
}

TEST_F(StopSignalTest, TheSecondSignalEndsTheProgram) {
  const auto run = [](int first, int second) {
    CatchSignals();
    raise(first);
    raise(second);
    std::exit(0);
  };
  EXPECT_EXIT(run(SIGINT, SIGINT), testing::KilledBySignal(SIGINT), "");
  EXPECT_EXIT(run(SIGINT, SIGTERM), testing::KilledBySignal(SIGTERM), "");
  EXPECT_EXIT(run(SIGTERM, SIGINT), testing::KilledBySignal(SIGINT), "");
}

TEST_F(StopSignalTest, ASignalThatIsSwitchedOffStaysOff) {
  const auto run = [] {
    signal(SIGINT, SIG_IGN);
    CatchSignals();
    raise(SIGINT);
    raise(SIGINT);
    ExitAsTold(5);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(5), "\\[\\]");
}

TEST_F(StopSignalTest, AFileThatGrowsTooLargeDoesNotEndTheProgram) {
  const auto run = [] {
    CatchSignals();
    raise(SIGXFSZ);
    ExitAsTold(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(0), "\\[\\]");
}

}  // namespace
}  // namespace plumbline
