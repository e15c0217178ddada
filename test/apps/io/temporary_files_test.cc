#include "plumbline/apps/io/temporary_files.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

// Files are deleted for good: every test has a process of its own.
class TemporaryFilesTest : public testing::Test {
 protected:
  TemporaryFilesTest() { GTEST_FLAG_SET(death_test_style, "fast"); }  // with the folder of this one

  const std::string folder_ = TempFolder();
  const std::string a_ = folder_ + "a", b_ = folder_ + "b";
};

TEST_F(TemporaryFilesTest, DeletesThoseOfTheList) {
  WriteFile(a_, "");
  WriteFile(b_, "");
  const auto run = [this] {
    {
      TemporaryFiles files;
      files.Add(a_);
      files.Add(b_);
      files.Remove(a_);
    }
    TemporaryFiles::DeleteForGood();
    TemporaryFiles::DeleteForGood();
    _exit(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(0), "");
  EXPECT_TRUE(std::filesystem::exists(a_));
  EXPECT_FALSE(std::filesystem::exists(b_));
}

TEST_F(TemporaryFilesTest, NoFileIsMadeAfterThat) {
  const auto run = [this] {
    TemporaryFiles::DeleteForGood();
    std::thread([this] {
      TemporaryFiles files;
      WriteFile(a_, "");
      files.Add(a_);
    }).detach();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    _exit(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(0), "");
  EXPECT_EQ(NumFilesIn(folder_), 0);
}

// Or the handler would wait for what it interrupts.
TEST_F(TemporaryFilesTest, ASignalWaitsUntilTheListIsRight) {
  const auto run = [this] {
    signal(SIGTERM, [](int) {
      TemporaryFiles::DeleteForGood();
      _exit(3);
    });
    {
      TemporaryFiles files;
      raise(SIGTERM);
      WriteFile(a_, "");
      files.Add(a_);
    }
    _exit(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(3), "");
  EXPECT_EQ(NumFilesIn(folder_), 0);
}

}  // namespace
}  // namespace plumbline
