#include "plumbline/apps/program/stop_signal.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

// Signals are for the whole process: every test has one of its own.
class StopSignalTest : public testing::Test {
 protected:
  StopSignalTest() {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    signal(SIGHUP, SIG_DFL);  // nohup may have switched it off
  }
};

[[noreturn]] void ExitAsTold(int exit_code) {
  std::cerr << '[' << StopSignalName() << ']';
  std::exit(ExitCodeAfterStop(exit_code));
}

TEST_F(StopSignalTest, NothingHappensWithoutASignal) {
  const auto run = [] {
    CatchSignals("mapper");
    ExitAsTold(StopSignal() + 3);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(3), "\\[\\]");
}

TEST_F(StopSignalTest, ASignalAtTheStartEndsTheProgram) {
  const auto run = [](int number) {
    CatchSignals("bin/mapper");
    raise(number);
    std::exit(0);
  };
  EXPECT_EXIT(run(SIGINT), testing::ExitedWithCode(130),
              "^mapper: stopped by SIGINT while starting: nothing is written\n$");
  EXPECT_EXIT(run(SIGTERM), testing::ExitedWithCode(143), "stopped by SIGTERM while starting");
  EXPECT_EXIT(run(SIGHUP), testing::ExitedWithCode(129), "stopped by SIGHUP while starting");
}

TEST_F(StopSignalTest, ASignalWithNothingToWriteEndsTheProgramAndRemovesEmptyFolders) {
  GTEST_FLAG_SET(death_test_style, "fast");  // the program is to have the folders of this one
  const std::string folder = TempFolder(), kept = folder + "kept", made = folder + "made";
  std::filesystem::create_directories(kept);
  std::filesystem::create_directories(made + "/inner");
  WriteFile(kept + "/file", "");
  const auto run = [&] {
    CatchSignals("mapper");
    EndIfStoppedWhile("seeding", {made + "/inner", made, kept});
    raise(SIGINT);
    std::exit(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(130), "stopped by SIGINT while seeding");
  EXPECT_FALSE(std::filesystem::exists(made));
  EXPECT_TRUE(std::filesystem::exists(kept + "/file"));
}

TEST_F(StopSignalTest, ASignalDuringTheWritingOfFilesLeavesThoseThatAreWhole) {
  GTEST_FLAG_SET(death_test_style, "fast");  // the program is to have the folder of this one
  const std::string folder = TempFolder();
  const auto run = [&folder](int number) {
    CatchSignals("mapper");
    EndIfStoppedWhileWriting();
    AtomicFile whole, half;
    if (!whole.Open(folder + "whole").ok() || !whole.Commit().ok()) std::exit(1);
    if (!half.Open(folder + "half").ok()) std::exit(1);
    half.stream() << "half" << std::flush;
    raise(number);
    std::exit(0);
  };
  EXPECT_EXIT(run(SIGTERM), testing::ExitedWithCode(143),
              "^mapper: stopped by SIGTERM while writing: no file is half-written\n$");
  EXPECT_TRUE(std::filesystem::exists(folder + "whole"));
  EXPECT_EQ(NumFilesIn(folder), 1);
  EXPECT_EXIT(run(SIGHUP), testing::ExitedWithCode(129), "SIGHUP while writing");
  EXPECT_EQ(NumFilesIn(folder), 1);
}

TEST_F(StopSignalTest, ASignalIsKeptOnceThereIsSomethingToWrite) {
  const auto run = [](int number) {
    CatchSignals("mapper");
    KeepStopSignal();
    raise(number);
    ExitAsTold(0);
  };
  EXPECT_EXIT(run(SIGINT), testing::ExitedWithCode(130),
              "mapper: stopped by SIGINT, ending in order.*\n\\[SIGINT\\]");
  EXPECT_EXIT(run(SIGTERM), testing::ExitedWithCode(143), "by SIGTERM.*\n\\[SIGTERM\\]");
  EXPECT_EXIT(run(SIGHUP), testing::ExitedWithCode(129), "by SIGHUP.*\n\\[SIGHUP\\]");
}

TEST_F(StopSignalTest, AKeptSignalEndsAProgramThatHasNothingToWriteAfterAll) {
  const auto run = [] {
    CatchSignals("mapper");
    KeepStopSignal();
    raise(SIGTERM);
    EndIfStoppedWhile("seeding");
    std::exit(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(143), "stopped by SIGTERM while seeding");
}

TEST_F(StopSignalTest, ASignalDuringTheLastWritingIsWrittenToo) {
  const auto run = [] {
    CatchSignals("mapper");
    KeepStopSignal();
    const Status written = WriteWithStopSignal([](const std::string& signal_name) {
      std::cerr << "{" << signal_name << "}";
      if (signal_name.empty()) raise(SIGINT);
      return Status::Ok();
    });
    ExitAsTold(written.ok() ? 0 : 1);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(130), "^\\{\\}.*\n\\{SIGINT\\}\\[SIGINT\\]$");
}

TEST_F(StopSignalTest, AFirstSignalAfterTheLastWritingIsIgnored) {
  const auto run = [] {
    CatchSignals("mapper");
    KeepStopSignal();
    const Status written =
        WriteWithStopSignal([](const std::string&) { return Status::InvalidArgument("disk"); });
    if (written.ok()) std::exit(1);
    if (!WriteWithStopSignal([](const std::string&) { return Status::Ok(); }).ok()) std::exit(1);
    raise(SIGINT);
    ExitAsTold(7);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(7), "^\\[\\]$");
}

TEST_F(StopSignalTest, TheSecondSignalEndsTheProgram) {
  const auto run = [](int first, int second) {
    CatchSignals("mapper");
    KeepStopSignal();
    raise(first);
    raise(second);
    std::exit(0);
  };
  EXPECT_EXIT(run(SIGINT, SIGINT), testing::KilledBySignal(SIGINT), "");
  EXPECT_EXIT(run(SIGINT, SIGTERM), testing::KilledBySignal(SIGTERM), "");
  EXPECT_EXIT(run(SIGTERM, SIGINT), testing::KilledBySignal(SIGINT), "");
}

TEST_F(StopSignalTest, TheSecondSignalLeavesNoFileHalfWritten) {
  GTEST_FLAG_SET(death_test_style, "fast");
  const std::string folder = TempFolder();
  const auto run = [&folder] {
    CatchSignals("mapper");
    KeepStopSignal();
    AtomicFile half;
    if (!half.Open(folder + "half").ok()) std::exit(1);
    raise(SIGTERM);
    raise(SIGINT);
    std::exit(0);
  };
  EXPECT_EXIT(run(), testing::KilledBySignal(SIGINT), "");
  EXPECT_EQ(NumFilesIn(folder), 0);
}

TEST_F(StopSignalTest, ASignalThatIsSwitchedOffStaysOff) {
  const auto run = [] {
    signal(SIGINT, SIG_IGN);
    CatchSignals("mapper");
    raise(SIGINT);
    raise(SIGINT);
    ExitAsTold(5);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(5), "\\[\\]");
  const auto run_to_its_end = [] {
    signal(SIGHUP, SIG_IGN);
    CatchSignals("mapper");
    KeepStopSignal();
    raise(SIGTERM);
    raise(SIGHUP);  // is no second one
    ExitAsTold(0);
  };
  EXPECT_EXIT(run_to_its_end(), testing::ExitedWithCode(143), "\\[SIGTERM\\]");
}

TEST_F(StopSignalTest, AFileThatGrowsTooLargeDoesNotEndTheProgram) {
  const auto run = [] {
    CatchSignals("mapper");
    raise(SIGXFSZ);
    ExitAsTold(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(0), "\\[\\]");
}

}  // namespace
}  // namespace plumbline
