#include "plumbline/apps/io/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

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
  {
    AtomicFile file;
    ASSERT_TRUE(file.Open(path).ok());
    std::filesystem::create_directories(path + "/inside");
    const Status status = file.Commit();
    EXPECT_EQ(status.code(), StatusCode::kUnavailable);
    EXPECT_THAT(status.message(), HasSubstr("cannot replace '" + path + "'"));
  }
  EXPECT_EQ(NumFilesIn(folder), 1);
}

TEST(AtomicFileTest, AFolderIsNoFile) {
  const std::string folder = TempFolder();
  const Status status = AtomicFile().Open(folder);
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_EQ(status.message(), "cannot write '" + folder + "': Is a directory");
}

TEST(AtomicFileTest, WhatALinkLeadsToIsWrittenAndTheLinkStays) {
  const std::string folder = TempFolder();
  std::filesystem::create_directory(folder + "other");
  std::filesystem::create_symlink("other/target", folder + "link");
  std::filesystem::create_symlink("link", folder + "link_to_link");
  for (const char* content : {"made", "replaced"}) {
    AtomicFile file;
    ASSERT_TRUE(file.Open(folder + "link_to_link").ok());
    EXPECT_EQ(NumFilesIn(folder), 3);  // the temporary file is beside the target
    file.stream() << content;
    ASSERT_TRUE(file.Commit().ok());
    EXPECT_EQ(ReadFile(folder + "other/target"), content);
  }
  EXPECT_TRUE(std::filesystem::is_symlink(folder + "link"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder + "link_to_link"));
  EXPECT_EQ(NumFilesIn(folder + "other"), 1);
}

TEST(AtomicFileTest, LinksInACircleAreReported) {
  const std::string folder = TempFolder(), path = folder + "a";
  std::filesystem::create_symlink("b", path);
  std::filesystem::create_symlink("a", folder + "b");
  EXPECT_THAT(AtomicFile().Open(path).message(),
              HasSubstr("cannot write '" + path + "': Too many"));
  EXPECT_EQ(NumFilesIn(folder), 2);
}

TEST(AtomicFileTest, AFileThatIsReplacedHandsOnItsPermissions) {
  const std::string path = TempFolder() + "a.txt";
  WriteFile(path, "old");
  for (const auto permissions : {std::filesystem::perms(0640), std::filesystem::perms(0444)}) {
    std::filesystem::permissions(path, permissions);
    AtomicFile file;
    ASSERT_TRUE(file.Open(path).ok());
    ASSERT_TRUE(file.Commit().ok());
    EXPECT_EQ(std::filesystem::status(path).permissions(), permissions);
  }
}

// Through a link, so that a mistake costs the link and no device.
TEST(AtomicFileTest, ADeviceIsWrittenAndStays) {
  const std::string folder = TempFolder(), path = folder + "full";
  std::filesystem::create_symlink("/dev/full", path);
  EXPECT_TRUE(CheckWritable(path).ok());
  {
    AtomicFile file;
    ASSERT_TRUE(file.Open(path).ok());
    file.stream() << "text";
    EXPECT_EQ(file.Commit().message(), "cannot write '" + path + "': No space left on device");
  }
  EXPECT_TRUE(std::filesystem::is_character_file(path));
  EXPECT_EQ(NumFilesIn(folder), 1);
}

TEST(AtomicFileTest, APipeIsWritten) {
  const std::string folder = TempFolder(), path = folder + "pipe";
  ASSERT_EQ(mkfifo(path.c_str(), 0600), 0);
  EXPECT_TRUE(CheckWritable(path).ok());  // without waiting for a reader
  std::string read;
  std::thread reader([&] { read = ReadFile(path); });
  AtomicFile file;
  const Status opened = file.Open(path);
  file.stream() << "text";
  const Status committed = file.Commit();
  reader.join();
  EXPECT_TRUE(opened.ok() && committed.ok());
  EXPECT_EQ(read, "text");
  EXPECT_TRUE(std::filesystem::is_fifo(path));
}

TEST(AtomicFileTest, AnotherProcessTemporaryFileIsNotTouched) {
  const std::string folder = TempFolder(), path = folder + "a.txt";
  // Of a killed run with the number of this process: whatever its counter, the next ones are taken.
  AtomicFile first;
  ASSERT_TRUE(first.Open(path).ok());
  const std::string name = std::filesystem::directory_iterator(folder)->path().string();
  const std::size_t dash = name.rfind('-') + 1;
  const int counter = std::stoi(name.substr(dash));
  const std::string taken = name.substr(0, dash) + std::to_string(counter + 1) + ".tmp";
  WriteFile(taken, "theirs");
  AtomicFile second;
  ASSERT_TRUE(second.Open(path).ok());
  second.stream() << "mine";
  ASSERT_TRUE(second.Commit().ok());
  EXPECT_EQ(ReadFile(taken), "theirs");
  EXPECT_EQ(ReadFile(path), "mine");
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
