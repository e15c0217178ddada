#include "plumbline/apps/bags/ros1_records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A header or the data of a record that says to be of this length.
std::string Part(unsigned length, const std::string& content) {
  std::string part;
  for (int shift = 0; shift < 32; shift += 8) part += static_cast<char>(length >> shift & 255);
  return part + content;
}

std::string Part(const std::string& content) {
  return Part(static_cast<unsigned>(content.size()), content);
}

// A number of four bytes.
std::string Number(unsigned number) { return Part(number, ""); }

std::string Record(const std::vector<std::string>& fields, const std::string& data) {
  std::string header;
  for (const std::string& field : fields) header += Part(field);
  return Part(header) + Part(data);
}

std::string Chunk(const std::string& compression, const std::string& data) {
  return Record({"op=\x05", "compression=" + compression,
                 "size=" + Number(static_cast<unsigned>(data.size()))},
                data);
}

std::string Index(unsigned count, unsigned offset) {
  return Record({"op=\x04", "count=" + Number(count)}, "the time" + Number(offset));
}

class Ros1RecordsTest : public testing::Test {
 protected:
  Status Check(const std::string& content) const {
    WriteFile(path_, content);
    return CheckRos1Records(path_);
  }

  const std::string path_ = TempFolder() + "a.bag";
  const std::string bag_ = "#ROSBAG V2.0\n" + Part(8, Part(4, "op=2")) + Part(5, "12345");
  // A connection, whose data are a header too.
  const std::string connection_ = Part(8, Part(4, "op=\x07"));
};

TEST_F(Ros1RecordsTest, TakesWholeBags) {
  EXPECT_TRUE(Check(bag_ + connection_ + Part(7, Part(3, "a=b"))).ok());
  EXPECT_TRUE(Check("#ROSBAG V2.0\n").ok());
}

// The library would read all but the last as bags.
TEST_F(Ros1RecordsTest, RefusesOtherFormats) {
  for (const std::string start : {"#ROSBGA V2.0\n", "#ROSBAG V2.00\n", "#ROSBAG V1.2\n", ""}) {
    const Status status = Check(start + Part(9, ""));
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(), HasSubstr("it does not begin with the line '#ROSBAG V2.0'"));
  }
}

TEST_F(Ros1RecordsTest, NamesWhereLengthsAreWrong) {
  const std::string at = "the record at byte " + std::to_string(bag_.size());
  for (const std::string& end :
       {Part(2, "x"), Part(0xffffffff, "xyz"), std::string("abc"), Part(0, ""), Part(3, "a=b"),
        Part(7, Part(9, "a=b")) + Part(0, ""), Part(7, Part(3, "abc")) + Part(0, ""),
        connection_ + Part(7, Part(9, "a=b")), connection_ + Part(3, "")}) {
    const Status status = Check(bag_ + end);
    EXPECT_EQ(status.code(), StatusCode::kDataLoss);
    EXPECT_THAT(status.message(), HasSubstr(path_ + ": cannot be read as a ROS bag: " + at));
  }
}

TEST_F(Ros1RecordsTest, NamesWhatPointsNowhere) {
  const std::string start = "#ROSBAG V2.0\n", connection = Record({"op=\x07"}, Part("a=b"));
  const std::string message = Record({"op=\x02"}, "content");
  const unsigned message_at = connection.size();
  const std::string chunk = Chunk("none", connection + message + connection);
  const auto expect_damaged = [&](const std::string& before, const std::string& damaged) {
    EXPECT_THAT(Check(before + damaged).message(),
                HasSubstr("the record at byte " + std::to_string(before.size()) + " is damaged"));
  };
  // To a message, also by way of the connection before it.
  EXPECT_TRUE(Check(start + chunk + Index(1, message_at) + Index(1, 0)).ok());
  expect_damaged(start + chunk, Index(1, message_at + 1));
  expect_damaged(start + chunk, Index(1, message_at + message.size()));
  expect_damaged(start + chunk, Index(2, message_at));
  expect_damaged(start, Index(1, 0));
  expect_damaged(start, Record({"op=\x05", "compression=none", "size=" + Number(99)}, message));
  expect_damaged(start, Chunk("none", message + Part(9, "")));
  expect_damaged(start, Chunk("none", Record({"op=\x07"}, "ab")));
  // Of what is compressed the size is all that is known.
  EXPECT_TRUE(Check(start + Chunk("lz4", "12345") + Index(1, 4)).ok());
  expect_damaged(start + Chunk("lz4", "12345"), Index(1, 5));
  // From the list of chunks to them, and from the first record to the lists at the end.
  EXPECT_TRUE(Check(start + chunk + Record({"op=\x06", "chunk_pos=" + Number(13)}, "")).ok());
  expect_damaged(start + chunk, Record({"op=\x06", "chunk_pos=" + Number(14)}, ""));
  const std::string first = Record({"op=\x03", "index_pos=" + Number(0)}, "");
  const unsigned end = start.size() + first.size() + chunk.size();
  for (const unsigned at : {0u, end - static_cast<unsigned>(chunk.size()), end}) {
    EXPECT_TRUE(Check(start + Record({"op=\x03", "index_pos=" + Number(at)}, "") + chunk).ok());
  }
  const std::string beyond = Record({"op=\x03", "index_pos=" + Number(end + 1)}, "");
  EXPECT_THAT(Check(start + beyond + chunk).message(), HasSubstr("the record at byte 13 is"));
}

TEST_F(Ros1RecordsTest, NamesAFileThatIsNotThere) {
  EXPECT_EQ(CheckRos1Records(path_).code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace plumbline
