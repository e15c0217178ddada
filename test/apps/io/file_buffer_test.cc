#include "plumbline/apps/io/file_buffer.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>
#include <ostream>
#include <string>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

TEST(FileBufferTest, WritesTextAndBytesOfAnyLength) {
  const std::string path = TempFolder() + "a.bin";
  const std::string bytes(1000003, '\xff');
  FileBuffer buffer;
  ASSERT_TRUE(buffer.OpenNew(path, 0644));
  std::ostream stream(&buffer);
  stream << "text " << 7 << '\n' << bytes << '\0' << std::flush << "end";
  EXPECT_TRUE(buffer.Close());
  EXPECT_TRUE(stream.good());
  EXPECT_EQ(buffer.error(), 0);
  EXPECT_TRUE(ReadFile(path) == "text 7\n" + bytes + std::string(1, '\0') + "end");
}

TEST(FileBufferTest, TellsWhyAFileCannotBeMade) {
  FileBuffer buffer;
  EXPECT_FALSE(buffer.OpenNew(TempFolder() + "none/a.bin", 0644));
  EXPECT_EQ(buffer.error(), ENOENT);
  EXPECT_FALSE(FileBuffer().OpenExisting(TempFolder()));
}

TEST(FileBufferTest, ANewFileDoesNotReplaceAnother) {
  const std::string folder = TempFolder(), path = folder + "a.txt";
  WriteFile(path, "text");
  FileBuffer buffer;
  EXPECT_FALSE(buffer.OpenNew(path, 0644));
  EXPECT_EQ(buffer.error(), EEXIST);
  EXPECT_TRUE(buffer.OpenNew(folder + "b.txt", 0644));
  EXPECT_EQ(buffer.error(), 0);
  EXPECT_EQ(ReadFile(path), "text");
}

TEST(FileBufferTest, ACopyOfADescriptorWritesOnWhereItStands) {
  const std::string path = TempFolder() + "a.txt";
  FileBuffer buffer, copy;
  ASSERT_TRUE(buffer.OpenNew(path, 0644));
  ASSERT_TRUE(copy.OpenCopy(buffer.descriptor()));
  std::ostream(&copy) << "first";
  EXPECT_TRUE(copy.Close());
  std::ostream(&buffer) << " second";
  EXPECT_TRUE(buffer.Close());
  EXPECT_EQ(ReadFile(path), "first second");
  EXPECT_FALSE(FileBuffer().OpenCopy(-1));
}

TEST(FileBufferTest, WhatIsSentIsThereBeforeTheEnd) {
  const std::string path = TempFolder() + "a.txt";
  FileBuffer buffer;
  EXPECT_FALSE(buffer.Send());  // nothing is open
  ASSERT_TRUE(buffer.OpenNew(path, 0644));
  std::ostream(&buffer) << "first";
  EXPECT_EQ(ReadFile(path), "");
  EXPECT_TRUE(buffer.Send());
  EXPECT_EQ(ReadFile(path), "first");
  std::ostream(&buffer) << " second";
  EXPECT_TRUE(buffer.Close());
  EXPECT_EQ(ReadFile(path), "first second");
}

TEST(FileBufferTest, RemembersWhyWritingFailed) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  for (const std::size_t size : {1, 1000000}) {
    FileBuffer buffer;
    ASSERT_TRUE(buffer.OpenExisting("/dev/full"));
    std::ostream stream(&buffer);
    stream << std::string(size, 'x');
    errno = 0;
    stream << "more";
    EXPECT_FALSE(buffer.Close());
    EXPECT_EQ(buffer.error(), ENOSPC) << size;
  }
}

TEST(FileBufferTest, WhatIsNotClosedIsNotFlushed) {
  const std::string path = TempFolder() + "a.txt";
  {
    FileBuffer buffer;
    ASSERT_TRUE(buffer.OpenNew(path, 0644));
    std::ostream(&buffer) << "half";
  }
  EXPECT_EQ(ReadFile(path), "");
}

}  // namespace
}  // namespace plumbline
