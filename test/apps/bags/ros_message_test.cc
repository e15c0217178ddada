#include "plumbline/apps/bags/ros_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "plumbline/test/apps/bags/bag_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

RosEncoding Decoded(TestEncoding encoding) {
  return encoding == TestEncoding::kRos1 ? RosEncoding::kRos1 : RosEncoding::kCdr;
}

class RosMessageTest : public testing::TestWithParam<TestEncoding> {
 protected:
  std::string ScanFault(const std::string& bytes) const {
    RosScan scan;
    std::string fault;
    const bool ok = DecodeScan(Decoded(GetParam()), bytes, &scan, &fault);
    EXPECT_EQ(ok, fault.empty());
    return fault;
  }
  // A scan whose number of ranges, behind a frame of some length, is what it says to be.
  std::string ScanThatSays(std::uint32_t num_ranges, const std::string& frame = "laser") const {
    MessageWriter writer(GetParam());
    writer.Header(kStart_ns, frame);
    for (int i = 0; i < 7; ++i) writer.Single(i);
    writer.Unsigned(num_ranges);
    writer.Single(1.5);
    writer.Single(2.5);
    writer.Unsigned(0);
    return writer.bytes();
  }
};

TEST_P(RosMessageTest, ScansOfFramesOfAnyLengthAreAligned) {
  for (const std::string frame : {"", "a", "ab", "abc", "abcd", "abcde"}) {
    RosScan scan;
    std::string fault;
    ASSERT_TRUE(DecodeScan(Decoded(GetParam()), ScanThatSays(2, frame), &scan, &fault)) << fault;
    EXPECT_EQ(scan.stamp_s, 1500000000.0);
    EXPECT_EQ(scan.frame, frame);
    EXPECT_EQ(scan.angle_min_rad, 0.0);
    EXPECT_EQ(scan.angle_increment_rad, 2.0);
    EXPECT_EQ(scan.time_increment_s, 3.0);
    EXPECT_EQ(scan.range_min_m, 5.0);
    EXPECT_EQ(scan.range_max_m, 6.0);
    EXPECT_THAT(scan.ranges, testing::ElementsAre(1.5, 2.5));
  }
}

TEST_P(RosMessageTest, OdometryGivesPoseFramesAndTime) {
  RosOdometry odometry;
  std::string fault;
  const std::string bytes = OdometryBytes(GetParam(), kStart_ns + 500000000, {1.5, -2.5, 0.5});
  ASSERT_TRUE(DecodeOdometry(Decoded(GetParam()), bytes, &odometry, &fault)) << fault;
  EXPECT_EQ(odometry.stamp_s, 1500000000.5);
  EXPECT_EQ(odometry.frame, "odom");
  EXPECT_EQ(odometry.child_frame, "base_link");
  EXPECT_EQ(odometry.pose.position, Eigen::Vector3d(1.5, -2.5, 0.0));
  EXPECT_EQ(odometry.pose.rotation.z(), std::sin(0.25));
  EXPECT_EQ(odometry.pose.rotation.w(), std::cos(0.25));
}

TEST_P(RosMessageTest, TransformsComeOneAfterTheOther) {
  MessageWriter writer(GetParam());
  writer.Unsigned(3);
  for (int i = 0; i < 3; ++i) {
    writer.Header(kStart_ns, "parent");
    writer.Text(std::string(i, 'c'));
    writer.Pose({1.0 * i, 2.0, 0.5}, 3.0);
  }
  std::vector<RosTransform> transforms;
  std::string fault;
  ASSERT_TRUE(DecodeTransforms(Decoded(GetParam()), writer.bytes(), &transforms, &fault)) << fault;
  ASSERT_EQ(transforms.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(transforms[i].frame, "parent");
    EXPECT_EQ(transforms[i].child_frame, std::string(i, 'c'));
    EXPECT_EQ(transforms[i].pose.position, Eigen::Vector3d(i, 2.0, 3.0));
  }
}

TEST_P(RosMessageTest, CountsThatDoNotFitAreNamedAndNotAllocated) {
  EXPECT_THAT(ScanFault(ScanThatSays(2)), IsEmpty());
  for (const std::uint32_t count : {5u, 4000000000u, 4294967295u}) {
    EXPECT_EQ(ScanFault(ScanThatSays(count)), "field 'ranges': its " + std::to_string(count) +
                                                  " elements are more than the message holds");
  }
  MessageWriter writer(GetParam());
  writer.Unsigned(1000000);
  std::vector<RosTransform> transforms;
  std::string fault;
  EXPECT_FALSE(DecodeTransforms(Decoded(GetParam()), writer.bytes(), &transforms, &fault));
  EXPECT_THAT(fault, HasSubstr("field 'transforms': its 1000000 elements"));
  EXPECT_THAT(transforms, IsEmpty());
}

TEST_P(RosMessageTest, ATextLongerThanTheMessageIsNamed) {
  MessageWriter writer(GetParam());
  if (GetParam() == TestEncoding::kRos1) writer.Unsigned(1);
  writer.Unsigned(1);
  writer.Unsigned(2);
  writer.Unsigned(0xffffffff);
  EXPECT_EQ(ScanFault(writer.bytes() + "abc"),
            "field 'header.frame_id': its length is more than the message holds");
}

// Also a scan of ROS 2 may be followed by a few bytes, which fill it up.
TEST_P(RosMessageTest, EveryCutIsAFaultThatNamesAField) {
  const std::string scan = ScanThatSays(2);
  for (std::size_t size = 0; size < scan.size(); ++size) {
    EXPECT_THAT(ScanFault(scan.substr(0, size)), HasSubstr("field '")) << size;
  }
  const std::string odometry = OdometryBytes(GetParam(), kStart_ns, {});
  for (std::size_t size = 0; size < odometry.size(); ++size) {
    RosOdometry decoded;
    std::string fault;
    EXPECT_FALSE(DecodeOdometry(Decoded(GetParam()), odometry.substr(0, size), &decoded, &fault));
    EXPECT_THAT(fault, HasSubstr("field '")) << size;
  }
}

TEST_P(RosMessageTest, EveryFlippedByteIsReadOrNamed) {
  const std::string scan = ScanThatSays(2);
  const std::string transform = TransformBytes(GetParam(), kStart_ns, "a", "bc", {});
  for (const int change : {0x01, 0x80, 0xff}) {
    for (std::size_t i = 0; i < scan.size(); ++i) {
      std::string flipped = scan;
      flipped[i] = static_cast<char>(flipped[i] ^ change);
      const std::string fault = ScanFault(flipped);
      EXPECT_THAT(fault, testing::AnyOf(IsEmpty(), HasSubstr("field '"), HasSubstr("longer")));
    }
    for (std::size_t i = 0; i < transform.size(); ++i) {
      std::string flipped = transform, fault;
      flipped[i] = static_cast<char>(flipped[i] ^ change);
      std::vector<RosTransform> transforms;
      const bool ok = DecodeTransforms(Decoded(GetParam()), flipped, &transforms, &fault);
      EXPECT_EQ(ok, fault.empty()) << i;
    }
  }
}

TEST_P(RosMessageTest, AMessageOfALongerTypeIsAFault) {
  EXPECT_EQ(ScanFault(ScanThatSays(2) + std::string(12, 'x')),
            "it is 12 bytes longer than its type has it");
  const std::string filled_up = ScanFault(ScanThatSays(2) + std::string(3, '\0'));
  if (GetParam() == TestEncoding::kRos1) {
    EXPECT_EQ(filled_up, "it is 3 bytes longer than its type has it");
  } else {
    EXPECT_EQ(filled_up, "");
  }
}

INSTANTIATE_TEST_SUITE_P(Encodings, RosMessageTest,
                         testing::Values(TestEncoding::kRos1, TestEncoding::kCdr,
                                         TestEncoding::kBigEndianCdr));

TEST(CdrTest, OtherKindsOfCdrAreNamed) {
  const std::string bytes = ScanBytes(TestEncoding::kCdr, kStart_ns, {1.0}, LaserModel());
  for (const std::string& header :
       {std::string("\0\2\0\0", 4), std::string("\0\7\0\0", 4), std::string("\1\1\0\0", 4)}) {
    RosScan scan;
    std::string fault;
    EXPECT_FALSE(DecodeScan(RosEncoding::kCdr, header + bytes.substr(4), &scan, &fault));
    EXPECT_EQ(fault, "field 'encapsulation': it is not that of plain CDR");
  }
}

TEST(CdrTest, ATextWithoutItsZeroByteIsNamed) {
  MessageWriter writer(TestEncoding::kCdr);
  writer.Unsigned(1);
  writer.Unsigned(2);
  writer.Unsigned(3);
  RosScan scan;
  std::string fault;
  EXPECT_FALSE(DecodeScan(RosEncoding::kCdr, writer.bytes() + "abc", &scan, &fault));
  EXPECT_EQ(fault, "field 'header.frame_id': its text does not end with a zero byte");
}

TEST(CdrTest, TimesBeforeTheEpochAreNegative) {
  MessageWriter writer(TestEncoding::kCdr);
  writer.Unsigned(1);
  writer.Unsigned(0xffffffff);  // -1 s
  writer.Unsigned(500000000);
  writer.Text("a");
  writer.Text("b");
  writer.Pose({}, 0.0);
  std::vector<RosTransform> transforms;
  std::string fault;
  ASSERT_TRUE(DecodeTransforms(RosEncoding::kCdr, writer.bytes(), &transforms, &fault)) << fault;
  EXPECT_EQ(transforms[0].stamp_s, -0.5);
}

}  // namespace
}  // namespace plumbline
