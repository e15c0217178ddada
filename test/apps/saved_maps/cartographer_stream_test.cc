#include "plumbline/apps/saved_maps/cartographer_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "plumbline/test/apps/saved_maps/pbstream_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

const std::string kStart = "a.pbstream: cannot be read as a state of Cartographer: ";

void ExpectDamaged(const std::string& content, const std::string& problem) {
  CartographerStream stream("a.pbstream", content);
  while (stream.Next()) {
  }
  EXPECT_EQ(stream.status().code(), StatusCode::kDataLoss);
  EXPECT_THAT(stream.status().message(), HasSubstr(kStart + problem));
  EXPECT_FALSE(stream.Next());
}

TEST(CartographerStreamTest, HandsOutOneMessageAfterTheOther) {
  const std::string content = PbFile({"first", "", "third"});
  CartographerStream stream("a.pbstream", content);
  ASSERT_TRUE(stream.Next());
  EXPECT_EQ(stream.number(), 1u);
  EXPECT_EQ(stream.message(), "first");
  EXPECT_EQ(kPbMagic + PbFile({"first"}).substr(8) + std::string(stream.rest()), content);
  ASSERT_TRUE(stream.Next());
  EXPECT_EQ(stream.message(), "");
  ASSERT_TRUE(stream.Next());
  EXPECT_EQ(stream.message(), "third");
  EXPECT_EQ(stream.rest(), "");
  EXPECT_FALSE(stream.Next());
  EXPECT_TRUE(stream.status().ok());
  EXPECT_EQ(stream.Error("problem").message(), kStart + "message 3: problem");
}

TEST(CartographerStreamTest, MessagesThatAreWrittenAreRead) {
  const std::string text(100000, 'x');
  const std::string content = kPbMagic + CartographerMessage(text) + CartographerMessage("");
  CartographerStream stream("a.pbstream", content);
  ASSERT_TRUE(stream.Next());
  EXPECT_EQ(stream.message(), text);
  EXPECT_TRUE(stream.Next());
  EXPECT_FALSE(stream.Next());
  EXPECT_TRUE(stream.status().ok());
}

TEST(CartographerStreamTest, LengthsThatLieAreNamed) {
  const std::string gzip = GzipBytes("text"), whole = PbFile({"first"});
  ExpectDamaged(whole + PbLength(gzip.size() + 1) + gzip,
                "message 2: its length is said to be " + std::to_string(gzip.size() + 1) +
                    " bytes, but the file has " + std::to_string(gzip.size()) + " left");
  ExpectDamaged(whole + PbLength(~std::uint64_t{0}) + gzip,
                "message 2: its length is said to be 18446744073709551615 bytes");
  ExpectDamaged(whole + PbLength(gzip.size() - 1) + gzip,
                "message 2: the compressed data are cut off");
  ExpectDamaged(whole + "1234567", "message 2: the file ends within its length");
  // What is left of the second is taken for the length of a third.
  ExpectDamaged(whole + PbLength(gzip.size()) + gzip + "x", "message 3: the file ends within");
}

TEST(CartographerStreamTest, WhatIsNoStreamIsNamed) {
  ExpectDamaged("", "it does not begin as such files do");
  ExpectDamaged(kPbMagic.substr(0, 7), "it does not begin as such files do");
  ExpectDamaged("VERTEX_SE2 0 0 0 0", "it does not begin as such files do");
  ExpectDamaged(kPbMagic + PbLength(4) + "text", "message 1: the compressed data are damaged: ");
}

// 65 MiB of zeros in 66 kB, in several messages and in one.
TEST(CartographerStreamTest, BombsAreRefused) {
  const std::string gzip = GzipBytes(std::string(std::size_t{1} << 20, '\0'));
  std::string messages, together;
  for (int i = 0; i < 65; ++i) {
    messages += PbLength(gzip.size()) + gzip;
    together += gzip;
  }
  ExpectDamaged(kPbMagic + messages, "message 65: the compressed data expand to more than 0 bytes");
  ExpectDamaged(kPbMagic + PbLength(together.size()) + together,
                "message 1: the compressed data expand to more than 67108864 bytes");
}

TEST(CartographerStreamTest, NoMessageTakesMoreMemoryThanIsLeft) {
  const std::string content = PbFile({std::string(600, 'x'), std::string(500, 'x')});
  MemoryLimit memory(1000.0);
  CartographerStream stream("a.pbstream", content, &memory);
  EXPECT_TRUE(stream.Next());  // and gone with the next
  ASSERT_TRUE(memory.Keep(501));
  EXPECT_FALSE(stream.Next());
  EXPECT_EQ(stream.status().message(), "a.pbstream: message 2: " + memory.Fault());
}

}  // namespace
}  // namespace plumbline
