#include "plumbline/apps/program/disk_arrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <thread>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr std::size_t kBytes = 3 << 20;

// Pages of the process that are in files.
std::size_t PagesOfFiles() {
  const std::string text = ReadFile("/proc/self/statm");
  std::size_t total = 0, resident = 0, of_files = 0;
  std::istringstream(text) >> total >> resident >> of_files;
  return of_files;
}

TEST(DiskArraysTest, KeepWhatIsWrittenWhenTheirPagesAreLetGo) {
  const std::string folder = TempFolder();
  DiskArrays arrays;
  ASSERT_TRUE(arrays.Open(folder).ok());
  auto* const array = static_cast<unsigned char*>(arrays.Add(kBytes));
  ASSERT_NE(array, nullptr);
  EXPECT_TRUE(std::all_of(array, array + kBytes, [](unsigned char byte) { return byte == 0; }));
  for (std::size_t i = 0; i < kBytes; ++i) array[i] = static_cast<unsigned char>(i % 251);
  const std::size_t pages = PagesOfFiles();
  arrays.MakeRoom();
  EXPECT_LE(PagesOfFiles() + kBytes / 4096, pages);
  for (std::size_t i = 0; i < kBytes; ++i) ASSERT_EQ(array[i], i % 251) << i;
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  EXPECT_TRUE(arrays.Remove(array));
  EXPECT_FALSE(arrays.Remove(array));
}

TEST(DiskArraysTest, KnowWhichAreTheirs) {
  DiskArrays arrays;
  ASSERT_TRUE(arrays.Open(TempFolder()).ok());
  std::vector<char> other(kBytes);
  EXPECT_FALSE(arrays.Remove(other.data()));
  void* const first = arrays.Add(1);
  void* const second = arrays.Add(kBytes);
  EXPECT_NE(first, second);
  EXPECT_TRUE(arrays.Remove(first));
  EXPECT_TRUE(arrays.Remove(second));
}

TEST(DiskArraysTest, TakeRoomOnTheDiskAtOnceOrNotAtAll) {
  DiskArrays arrays;
  EXPECT_EQ(arrays.BytesFree(), 0.0);
  ASSERT_TRUE(arrays.Open(TempFolder()).ok());
  const double free = arrays.BytesFree();
  EXPECT_GT(free, 0.0);
  EXPECT_EQ(arrays.Add(static_cast<std::size_t>(2.0 * free)), nullptr);
}

TEST(DiskArraysTest, GoToTheNearestFolderThatIsThere) {
  const std::string folder = TempFolder();
  DiskArrays arrays;
  ASSERT_TRUE(arrays.Open(folder + "not/there/yet").ok());
  EXPECT_NE(arrays.Add(kBytes), nullptr);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(DiskArraysTest, AreRefusedWhereThereIsNoDisk) {
  // Not even the administrator may write here.
  DiskArrays of_system;
  const Status status = of_system.Open("/proc/none");
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("cannot keep arrays in '/proc': "));
  DiskArrays in_memory;
  EXPECT_THAT(in_memory.Open("/dev/shm").message(),
              HasSubstr("cannot keep arrays in '/dev/shm': it is no disk, but memory"));
}

TEST(DiskArraysTest, ServeSeveralThreads) {
  DiskArrays arrays;
  ASSERT_TRUE(arrays.Open(TempFolder()).ok());
  const auto work = [&arrays](int own) {
    for (int turn = 0; turn < 20; ++turn) {
      auto* const array = static_cast<char*>(arrays.Add(kBytes));
      ASSERT_NE(array, nullptr);
      std::memset(array, own, kBytes);
      arrays.MakeRoom();
      EXPECT_EQ(std::count(array, array + kBytes, static_cast<char>(own)), kBytes);
      EXPECT_TRUE(arrays.Remove(array));
    }
  };
  std::thread other(work, 1);
  work(2);
  other.join();
}

}  // namespace
}  // namespace plumbline
