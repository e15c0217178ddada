#include "plumbline/apps/io/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

TEST(AtomicFileTest, CommitPutsTheFileInPlace) {
  const std::string folder = TempFolder(), path = folder + "a.bin";
  const std::string content("text\n\0bytes", 11);
  AtomicFile file;
  ASSERT_TRUE(file.Open(path).ok());
  file.stream() << content;
  EXPECT_FALSE(std::filesystem::exists(path));
  ASSERT_TRUE(file.Commit().ok());
  EXPECT_EQ(ReadFile(path), content);
  EXPECT_EQ(NumFilesIn(folder), 1);
}

TEST(AtomicFileTest, CommitReplacesAnOlderFile) {
  const std::string folder = TempFolder(), path = folder + "a.txt";
  WriteFile(path, "a longer file of old");
  AtomicFile file;
  ASSERT_TRUE(file.Open(path).ok());
  file.stream() << "new";
  EXPECT_EQ(ReadFile(path), "a longer file of old");
  ASSERT_TRUE(file.Commit().ok());
  EXPECT_EQ(ReadFile(path), "new");
  EXPECT_EQ(NumFilesIn(folder), 1);
}

TEST(AtomicFileTest, NothingRemainsWithoutCommit) {
  const std::string folder = TempFolder(), path = folder + "a.txt";
  WriteFile(path, "old");
  {
    AtomicFile file;
    ASSERT_TRUE(file.Open(path).ok());
    file.stream() << "half";
  }
  EXPECT_EQ(ReadFile(path), "old");
  EXPECT_EQ(NumFilesIn(folder), 1);
}

TEST(AtomicFileTest, TwoWritersOfOneTargetDoNotMix) {
  const std::string folder = TempFolder(), path = folder + "a.txt";
  AtomicFile first, second;
  ASSERT_TRUE(first.Open(path).ok());
  ASSERT_TRUE(second.Open(path).ok());
  first.stream() << "first";
  second.stream() << "second";
  ASSERT_TRUE(first.Commit().ok());
  ASSERT_TRUE(second.Commit().ok());
  EXPECT_EQ(ReadFile(path), "second");
}

TEST(AtomicFileTest, NamesAMissingFolder) {
  const std::string path = TempFolder() + "none/a.txt";
  AtomicFile file;
  const Status status = file.Open(path);
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("cannot write '" + path + "'"));
  EXPECT_FALSE(file.Commit().ok());
}

TEST(AtomicFileTest, ATargetThatCannotBeReplacedIsReported) {
  const std::string folder = TempFolder(), path = folder + "taken";
  std::filesystem::create_directories(path + "/inside");
  {
    AtomicFile file;
    ASSERT_TRUE(file.Open(path).ok());
    const Status status = file.Commit();
    EXPECT_EQ(status.code(), StatusCode::kUnavailable);
    EXPECT_THAT(status.message(), HasSubstr("cannot replace '" + path + "'"));
  }
  EXPECT_EQ(NumFilesIn(folder), 1);
}

TEST(AtomicFileTest, AFolderThatVanishesIsReported) {
  const std::string folder = TempFolder() + "gone/", path = folder + "a.txt";
  std::filesystem::create_directories(folder);
  AtomicFile file;
  ASSERT_TRUE(file.Open(path).ok());
  file.stream() << "text";
  std::filesystem::remove_all(folder);
  EXPECT_THAT(file.Commit().message(),
              HasSubstr("cannot replace '" + path + "': No such file or directory"));
}

TEST(AtomicFileTest, TemporaryFilesAreKnownByTheirNames) {
  const std::string folder = TempFolder(), path = folder + "map.pgm";
  AtomicFile file;
  ASSERT_TRUE(file.Open(path).ok());
  const std::filesystem::directory_iterator entry(folder);
  EXPECT_EQ(TargetOfTemporary(entry->path().filename().string()), "map.pgm");
  EXPECT_EQ(TargetOfTemporary("a.1-2.txt.30-41.tmp"), "a.1-2.txt");
  for (const char* other : {"map.pgm", "map.tmp", "map.pgm.12.tmp", "map.pgm.1-.tmp", ".tmp", "",
                            "map.pgm-1-2.tmp", "map.pgm.1-2.tmp.png", "1-2.tmp"}) {
    EXPECT_EQ(TargetOfTemporary(other), "") << other;
  }
}

TEST(AtomicFileTest, AFullDiskIsReportedAtCommit) {
  const std::string folder = TempFolder(), path = folder + "a.txt";
  // The system's limit on the size of a file stands for the full disk.
  rlimit old_limit;
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  const rlimit limit{100000, old_limit.rlim_max};
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  {
    AtomicFile file;
    ASSERT_TRUE(file.Open(path).ok());
    file.stream() << std::string(200000, 'x');
    file.stream() << "y";
    const Status status = file.Commit();
    EXPECT_EQ(status.code(), StatusCode::kUnavailable);
    EXPECT_THAT(status.message(), HasSubstr("cannot write '" + path + "': File too large"));
  }
  setrlimit(RLIMIT_FSIZE, &old_limit);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(NumFilesIn(folder), 0);
}

}  // namespace
}  // namespace plumbline
