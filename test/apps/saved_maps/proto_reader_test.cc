#include "plumbline/apps/saved_maps/proto_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "plumbline/apps/saved_maps/proto_writer.h"
#include "plumbline/test/apps/saved_maps/pbstream_testing.h"

namespace plumbline {
namespace {

using testing::ElementsAre;

// The one field of a message.
ProtoReader FieldOf(const std::string& message) {
  ProtoReader fields(message);
  EXPECT_TRUE(fields.Next());
  return fields;
}

TEST(ProtoReaderTest, ReadsNumbersOfAllSizes) {
  for (const std::int64_t number :
       {std::int64_t{0}, std::int64_t{1}, std::int64_t{127}, std::int64_t{128}, std::int64_t{-1},
        std::int64_t{300}, std::numeric_limits<std::int64_t>::min(),
        std::numeric_limits<std::int64_t>::max()}) {
    const std::string message = PbTag(5, 0) + PbVarint(static_cast<std::uint64_t>(number));
    ProtoReader fields = FieldOf(message);
    EXPECT_EQ(fields.number(), 5u);
    EXPECT_EQ(fields.Int64(), number);
    EXPECT_EQ(fields.Int32(), static_cast<std::int32_t>(number));
    EXPECT_EQ(fields.field(), message);
    EXPECT_FALSE(fields.Next());
    EXPECT_TRUE(fields.ok());
  }
}

TEST(ProtoReaderTest, ReadsFieldsInTheirOrderAndSkipsOthers) {
  const std::string message = PbDouble(1, -2.5) + PbTag(9, 5) + "four" + PbBytes(1000, "text") +
                              PbInt(2, 3) + PbBytes(3, "");
  ProtoReader fields(message);
  ASSERT_TRUE(fields.Next());
  EXPECT_EQ(fields.Double(), -2.5);
  ASSERT_TRUE(fields.Next());
  EXPECT_EQ(fields.number(), 9u);
  ASSERT_TRUE(fields.Next());
  EXPECT_EQ(fields.number(), 1000u);
  EXPECT_EQ(fields.Bytes(), "text");
  ASSERT_TRUE(fields.Next());
  ASSERT_TRUE(fields.Next());
  EXPECT_EQ(fields.Bytes(), "");
  EXPECT_FALSE(fields.Next());
  EXPECT_TRUE(fields.ok());
}

TEST(ProtoReaderTest, RepeatedNumbersComePackedOrOneByOne) {
  const std::string packed = PbBytes(3, PbVarint(7) + PbVarint(300) + PbVarint(~std::uint64_t{0}));
  std::vector<std::int32_t> numbers;
  const auto take = [&numbers](std::int32_t number) { numbers.push_back(number); };
  FieldOf(packed).Int32s(take);
  FieldOf(PbInt(3, 12)).Int32s(take);
  EXPECT_THAT(numbers, ElementsAre(7, 300, -1, 12));
}

TEST(ProtoReaderTest, EveryCutOfAFieldIsNoticed) {
  const std::string last[] = {PbInt(1, 300), PbDouble(2, 1.5), PbBytes(300, "text")};
  for (const std::string& field : last) {
    for (std::size_t size = 1; size < field.size(); ++size) {
      ProtoReader fields(std::string_view(field).substr(0, size));
      EXPECT_FALSE(fields.Next()) << size;
      EXPECT_FALSE(fields.ok()) << size;
    }
  }
}

TEST(ProtoReaderTest, WhatIsNoFieldIsDamage) {
  const std::string endless(20, '\xff');
  for (const std::string& message :
       {PbTag(0, 0) + PbVarint(1), PbTag(1, 3), PbTag(1, 4), PbTag(1, 6), PbTag(1, 7),
        PbTag(1, 0) + endless, endless, PbTag(1, 2) + PbVarint(~std::uint64_t{0}) + "text"}) {
    ProtoReader fields(message);
    EXPECT_FALSE(fields.Next());
    EXPECT_FALSE(fields.ok());
    EXPECT_FALSE(fields.Next());
  }
}

TEST(ProtoReaderTest, AValueOfAnotherKindIsDamage) {
  ProtoReader integer = FieldOf(PbInt(1, 5));
  EXPECT_EQ(integer.Double(), 0.0);
  EXPECT_FALSE(integer.ok());
  ProtoReader real = FieldOf(PbDouble(1, 5.0));
  EXPECT_EQ(real.Int64(), 0);
  EXPECT_EQ(real.Bytes(), "");
  EXPECT_FALSE(real.ok());
  const std::string cut = PbBytes(1, PbVarint(5) + "\x80");
  ProtoReader numbers = FieldOf(cut);
  numbers.Int32s([](std::int32_t number) { EXPECT_EQ(number, 5); });
  EXPECT_FALSE(numbers.ok());
}

TEST(ProtoWriterTest, WritesWhatOthersWrite) {
  ProtoWriter writer;
  writer.Double(2, -0.75);
  writer.Bytes(100, std::string(300, 'x'));
  writer.Field(PbInt(7, 12345));
  EXPECT_EQ(writer.bytes(),
            PbDouble(2, -0.75) + PbBytes(100, std::string(300, 'x')) + PbInt(7, 12345));
}

}  // namespace
}  // namespace plumbline
