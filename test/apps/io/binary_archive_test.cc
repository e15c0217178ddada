#include "plumbline/apps/io/binary_archive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace plumbline {

struct Thing {
  int number = 0;
  std::vector<double> values;
  bool yes = false;
};

template <typename Archive>
void Visit(Archive& archive, Thing* thing) {
  auto& [number, values, yes] = *thing;
  archive(number, values, yes);
}

namespace {

std::string BytesOf(std::vector<Thing> things, std::string text) {
  BinaryWriter writer;
  writer(things, text);
  return writer.bytes();
}

const double kInfinity = std::numeric_limits<double>::infinity();

TEST(BinaryArchiveTest, GivesBackEveryBit) {
  std::vector<Thing> written = {{-3, {0.1, -0.0, 5e-324, kInfinity}, true},
                                {std::numeric_limits<int>::min(), {}, false}};
  const std::string bytes = BytesOf(written, "words\n");
  std::vector<Thing> read;
  std::string text;
  BinaryReader reader(bytes);
  reader(read, text);
  EXPECT_TRUE(reader.ok());
  EXPECT_TRUE(reader.at_end());
  EXPECT_EQ(text, "words\n");
  ASSERT_EQ(read.size(), 2u);
  EXPECT_EQ(read[0].number, -3);
  EXPECT_EQ(read[0].values, written[0].values);
  EXPECT_TRUE(std::signbit(read[0].values[1]));
  EXPECT_TRUE(read[0].yes);
  EXPECT_EQ(read[1].number, std::numeric_limits<int>::min());
}

TEST(BinaryArchiveTest, NoticesThatTheEndIsMissing) {
  const std::string bytes = BytesOf({{1, {2.0}, true}}, "text");
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    std::vector<Thing> things;
    std::string text;
    BinaryReader reader(std::string_view(bytes).substr(0, size));
    reader(things, text);
    EXPECT_FALSE(reader.ok()) << size;
  }
}

TEST(BinaryArchiveTest, RefusesWhatAValueCannotBe) {
  std::string bytes = BytesOf({{1, {}, true}}, "");
  std::vector<Thing> things;
  bytes[8 + 8 + 8] = 2;  // a bool
  BinaryReader no_bool(bytes);
  no_bool(things);
  EXPECT_FALSE(no_bool.ok());
  bytes[8 + 8 + 8] = 1;
  bytes[8 + 4] = 1;  // an int beyond 32 bits
  BinaryReader no_int(bytes);
  no_int(things);
  EXPECT_FALSE(no_int.ok());
}

TEST(BinaryArchiveTest, DoesNotAllocateWhatCannotBeThere) {
  const std::string bytes(16, '\x7f');
  std::vector<double> values;
  BinaryReader reader(bytes);
  reader(values);
  EXPECT_FALSE(reader.ok());
  EXPECT_TRUE(values.empty());
}

}  // namespace
}  // namespace plumbline
