#include "plumbline/apps/io/rosbag_records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "plumbline/test/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A header or the data of a record that says to be of this length.
std::string Part(unsigned length, const std::string& content) {
  std::string part;
  for (int shift = 0; shift < 32; shift += 8) part += static_cast<char>(length >> shift & 255);
  return part + content;
}

class RosbagRecordsTest : public testing::Test {
 protected:
  Status Check(const std::string& content) const {
    WriteFile(path_, content);
    return CheckRosbagRecords(path_);
  }

  const std::string path_ = TempFolder() + "a.bag";
  const std::string bag_ = "#ROSBAG V2.0\n" + Part(8, Part(4, "op=2")) + Part(5, "12345");
  // A connection, whose data are a header too.
  const std::string connection_ = Part(8, Part(4, "op=\x07"));
};

TEST_F(RosbagRecordsTest, TakesWholeBagsAndWhatIsNone) {
  EXPECT_TRUE(Check(bag_ + connection_ + Part(7, Part(3, "a=b"))).ok());
  EXPECT_TRUE(Check("#ROSBAG V2.0\n").ok());
  EXPECT_TRUE(Check("#ROSBAG V1.2\n" + Part(9, "")).ok());
  EXPECT_TRUE(Check("").ok());
}

TEST_F(RosbagRecordsTest, NamesWhereLengthsAreWrong) {
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

TEST_F(RosbagRecordsTest, NamesAFileThatIsNotThere) {
  EXPECT_EQ(CheckRosbagRecords(path_).code(), StatusCode::kNotFound);
}

}  // namespace
}  // namespace plumbline
