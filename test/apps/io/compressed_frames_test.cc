#include "plumbline/apps/io/compressed_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/ros1_writer.h"
#include "plumbline/test/apps/io/gzip_bytes.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

std::string Compress(FrameFormat format, const std::string& bytes) {
  switch (format) {
    case FrameFormat::kLz4:
      return Lz4Bytes(bytes);
    case FrameFormat::kZstd:
      return ZstdBytes(bytes);
    case FrameFormat::kBzip2:
      return Bzip2Bytes(bytes);
    case FrameFormat::kGzip:
      break;
  }
  return GzipBytes(bytes);
}

class CompressedFramesTest : public testing::TestWithParam<FrameFormat> {
 protected:
  CompressedFramesTest() {
    for (int i = 0; i < 300000; ++i) text_ += static_cast<char>((i % 251) * (i % 251) % 251);
  }
  Status Expand(std::string_view frames, std::size_t max_size) {
    return ExpandFrames(GetParam(), frames, max_size, &expanded_);
  }

  std::string text_, expanded_ = "from before";
};

TEST_P(CompressedFramesTest, ExpandsFramesOneAfterTheOther) {
  const std::string frames = Compress(GetParam(), text_) + Compress(GetParam(), "the end");
  ASSERT_TRUE(Expand(frames, text_.size() + 7).ok());
  EXPECT_EQ(expanded_, text_ + "the end");
  ASSERT_TRUE(Expand("", 0).ok());
  EXPECT_EQ(expanded_, "");
}

TEST_P(CompressedFramesTest, BlocksMayEndAnywhere) {
  const std::string frame = Compress(GetParam(), text_);
  std::size_t at = 0;
  const auto next_block = [&] {
    const std::string_view block = std::string_view(frame).substr(at, 7);
    at += block.size();
    return block;
  };
  ASSERT_TRUE(ExpandFrames(GetParam(), next_block, text_.size(), &expanded_).ok());
  EXPECT_EQ(expanded_, text_);
}

TEST_P(CompressedFramesTest, WhatIsCutOffIsDataLoss) {
  const std::string frame = Compress(GetParam(), text_);
  for (std::size_t size = 1; size < frame.size(); size += 1 + size / 50) {
    const Status status = Expand(frame.substr(0, size), text_.size());
    EXPECT_EQ(status.code(), StatusCode::kDataLoss) << size;
    EXPECT_EQ(status.message(), "the compressed data are cut off") << size;
  }
}

TEST_P(CompressedFramesTest, WhatIsNoFrameIsDataLoss) {
  const Status status = Expand("these are no compressed data at all", 1000);
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_THAT(status.message(), HasSubstr("the compressed data are damaged: "));
}

// A few kB for 100 MB.
TEST_P(CompressedFramesTest, StopsAtTheLimit) {
  const std::string frame = Compress(GetParam(), std::string(1 << 20, '\0'));
  std::string frames;
  for (int i = 0; i < 100; ++i) frames += frame;
  const Status status = Expand(frames, 3000000);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(status.message(), "the compressed data expand to more than 3000000 bytes");
  EXPECT_LE(expanded_.size(), 3000000u);
}

INSTANTIATE_TEST_SUITE_P(Formats, CompressedFramesTest,
                         testing::Values(FrameFormat::kLz4, FrameFormat::kZstd, FrameFormat::kGzip,
                                         FrameFormat::kBzip2));

TEST(GzipFrameTest, WhatIsWrittenCanBeRead) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{1000000}}) {
    std::string bytes, expanded;
    for (std::size_t i = 0; i < size; ++i) bytes += static_cast<char>((i % 251) * (i % 251) % 251);
    const std::string frame = GzipFrame(bytes);
    ASSERT_TRUE(ExpandFrames(FrameFormat::kGzip, frame, size, &expanded).ok());
    EXPECT_EQ(expanded, bytes);
    EXPECT_LT(frame.size(), size / 2 + 100);
    EXPECT_EQ(GzipFrame(bytes), frame);
  }
}

TEST(ZstdFrameTest, FramesOfZstdAreToldByTheirStart) {
  EXPECT_TRUE(StartsWithZstdFrame(ZstdBytes("a")));
  EXPECT_FALSE(StartsWithZstdFrame(Lz4Bytes("a")));
  EXPECT_FALSE(StartsWithZstdFrame(""));
}

}  // namespace
}  // namespace plumbline
