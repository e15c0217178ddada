#include "plumbline/apps/program/disk_arrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "plumbline/apps/program/resident_memory.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr std::size_t kBytes = 3 << 20;

double BytesOfFiles() {
  const Resident resident = ResidentMemory().Read();
  return resident.total - resident.unshared;
}

class DiskArraysTest : public testing::Test {
 protected:
  void SetUp() override {
    const Status status = arrays_.Open(folder_ + "not/there/yet");
    if (!status.ok()) GTEST_SKIP() << status.message();
  }

  const std::string folder_ = TempFolder();
  DiskArrays arrays_;
};

TEST_F(DiskArraysTest, KeepWhatIsWrittenWhenTheirPagesAreLetGo) {
  auto* const array = static_cast<unsigned char*>(arrays_.Add(kBytes));
  ASSERT_NE(array, nullptr);
  EXPECT_TRUE(std::all_of(array, array + kBytes, [](unsigned char byte) { return byte == 0; }));
  for (std::size_t i = 0; i < kBytes; ++i) array[i] = static_cast<unsigned char>(i % 251);
  const double before = BytesOfFiles();
  arrays_.MakeRoom();
  EXPECT_LE(BytesOfFiles() + 0.5 * kBytes, before);
  for (std::size_t i = 0; i < kBytes; ++i) ASSERT_EQ(array[i], i % 251) << i;
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  EXPECT_TRUE(arrays_.Remove(array));
  EXPECT_FALSE(arrays_.Remove(array));
}

TEST_F(DiskArraysTest, KnowWhichAreTheirs) {
  std::vector<char> other(kBytes);
  EXPECT_FALSE(arrays_.Remove(other.data()));
  void* const first = arrays_.Add(1);
  void* const second = arrays_.Add(kBytes);
  EXPECT_NE(first, second);
  EXPECT_TRUE(arrays_.Remove(first));
  EXPECT_TRUE(arrays_.Remove(second));
}

TEST_F(DiskArraysTest, TakeRoomOnTheDiskAtOnceOrNotAtAll) {
  EXPECT_EQ(DiskArrays().BytesFree(), 0.0);
  const double free = arrays_.BytesFree();
  EXPECT_GT(free, 0.0);
  EXPECT_EQ(arrays_.Add(static_cast<std::size_t>(2.0 * free)), nullptr);
}

TEST_F(DiskArraysTest, AreRefusedWhereThereIsNoDisk) {
  // Not even the administrator may write here.
  DiskArrays of_system;
  const Status status = of_system.Open("/proc/none");
  EXPECT_EQ(status.code(), StatusCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("cannot keep arrays in '/proc': "));
  DiskArrays in_memory;
  if (!std::filesystem::exists("/dev/shm")) GTEST_SKIP() << "no /dev/shm";
  EXPECT_THAT(in_memory.Open("/dev/shm").message(),
              HasSubstr("cannot keep arrays in '/dev/shm': it is no disk, but memory"));
}

TEST_F(DiskArraysTest, ServeSeveralThreads) {
  const auto work = [this](int own) {
    for (int turn = 0; turn < 20; ++turn) {
      auto* const array = static_cast<char*>(arrays_.Add(kBytes));
      ASSERT_NE(array, nullptr);
      std::memset(array, own, kBytes);
      arrays_.MakeRoom();
      EXPECT_EQ(std::count(array, array + kBytes, static_cast<char>(own)), kBytes);
      EXPECT_TRUE(arrays_.Remove(array));
    }
  };
  std::thread other(work, 1);
  work(2);
  other.join();
}

}  // namespace
}  // namespace plumbline
