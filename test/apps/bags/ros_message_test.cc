#include "plumbline/apps/bags/ros_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/scan_message_testing.h"

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

// The laser of the 2D recordings published with Cartographer: a Hokuyo UTM-30LX-EW.
TEST_P(RosMessageTest, OneEchoOfABeamIsTaken) {
  LaserModel laser;
  laser.num_beams = 4;
  laser.first_bearing_rad = -2.35619449615;
  laser.bearing_step_rad = 0.00436332309619;
  laser.min_range_m = 0.0230000019073;
  laser.max_range_m = 60.0;
  const std::vector<std::vector<double>> ranges = {{1.5, 2.5}, {}, {3.5}, {4.5, 5.5, 6.5}};
  const std::vector<std::vector<double>> intensities = {{10, 20}, {}, {5}, {3, 9, 4}};
  RosScan scan;
  std::string fault;
  const auto decode = [&](RosEcho echo, const auto& with_intensities) {
    const std::string bytes =
        MultiEchoBytes(GetParam(), kStart_ns, ranges, with_intensities, laser);
    return DecodeMultiEchoScan(Decoded(GetParam()), bytes, echo, &scan, &fault);
  };
  constexpr double kNone = std::numeric_limits<double>::infinity();
  ASSERT_TRUE(decode(RosEcho::kFirst, intensities)) << fault;
  EXPECT_EQ(scan.stamp_s, 1500000000.0);
  EXPECT_EQ(scan.frame, "laser");
  EXPECT_EQ(scan.angle_increment_rad, static_cast<float>(laser.bearing_step_rad));
  EXPECT_EQ(scan.range_max_m, 60.0);
  EXPECT_THAT(scan.ranges, testing::ElementsAre(1.5, kNone, 3.5, 4.5));
  ASSERT_TRUE(decode(RosEcho::kStrongest, intensities)) << fault;
  EXPECT_THAT(scan.ranges, testing::ElementsAre(2.5, kNone, 3.5, 5.5));
  const std::vector<std::vector<double>> none;
  ASSERT_TRUE(decode(RosEcho::kFirst, none)) << fault;
  EXPECT_FALSE(decode(RosEcho::kStrongest, none));
  EXPECT_THAT(fault, HasSubstr("field 'intensities': it does not have one for each echo"));
}

TEST_P(RosMessageTest, PointsOfCloudsOfAnyLayoutAreRead) {
  const std::vector<std::array<double, 3>> points = {
      {1.5, -2.5, 0.25}, {3.0, 4.0, 5.0}, {std::nan(""), 0.0, 1.0}, {-1.0, 0.0, 0.5}};
  CloudLayout doubles{{{"x", 4, 8}, {"y", 12, 8}, {"z", 20, 8}, {"rgb", 0}}, 29};
  CloudLayout backwards = PlanarLayout();
  std::swap(backwards.fields[0].offset, backwards.fields[2].offset);
  CloudLayout rows = OusterLayout();
  rows.height = 2;
  rows.row_padding = 16;
  for (CloudLayout layout : {VelodyneLayout(), rows, PlanarLayout(), doubles, backwards}) {
    for (const bool is_big_endian : {false, true}) {
      layout.is_big_endian = is_big_endian;
      RosCloud cloud;
      std::string fault;
      const std::string bytes = CloudBytes(GetParam(), kStart_ns, "lidar", points, layout);
      ASSERT_TRUE(DecodeCloud(Decoded(GetParam()), bytes, &cloud, &fault)) << fault;
      EXPECT_EQ(cloud.stamp_s, 1500000000.0);
      EXPECT_EQ(cloud.frame, "lidar");
      ASSERT_EQ(cloud.points.size(), points.size());
      EXPECT_EQ(cloud.points[0], Eigen::Vector3d(1.5, -2.5, 0.25));
      EXPECT_EQ(cloud.points[1], Eigen::Vector3d(3.0, 4.0, 5.0));
      EXPECT_TRUE(std::isnan(cloud.points[2].x()));
      EXPECT_EQ(cloud.points[3], Eigen::Vector3d(-1.0, 0.0, 0.5));
    }
  }
}

TEST_P(RosMessageTest, CloudsThatDoNotFitAreNamed) {
  const std::vector<std::array<double, 3>> points(4, {1.0, 2.0, 3.0});
  const auto expect_fault = [&](const std::string& bytes, const std::string& expected) {
    RosCloud cloud;
    std::string fault;
    EXPECT_FALSE(DecodeCloud(Decoded(GetParam()), bytes, &cloud, &fault));
    EXPECT_THAT(fault, HasSubstr(expected));
    EXPECT_THAT(cloud.points, IsEmpty());
  };
  const auto bytes_of = [&](const CloudLayout& layout) {
    return CloudBytes(GetParam(), kStart_ns, "lidar", points, layout);
  };
  CloudLayout layout = VelodyneLayout();
  layout.fields[2].name = "depth";
  expect_fault(bytes_of(layout), "field 'fields': x, y and z are not all among them");
  layout = VelodyneLayout();
  layout.fields[1].datatype = 6;
  expect_fault(bytes_of(layout), "field 'fields': 'y' is neither FLOAT32 nor FLOAT64");
  layout = {{{"x", 0}, {"y", 4}, {"z", 6}}, 8};
  layout.row_padding = 4;  // for the z of the last point
  expect_fault(bytes_of(layout), "field 'point_step': it is less than the fields take");
  // Height and width that exceed the data, some with a product that overflows.
  const std::string good = bytes_of(VelodyneLayout());
  MessageWriter start(GetParam());
  start.Header(kStart_ns, "lidar");
  const std::size_t at = (start.bytes().size() + 3) / 4 * 4;  // of height
  for (const unsigned size : {5u, 0x7fffffffu, 0xffffffffu}) {
    MessageWriter sizes(GetParam());
    sizes.Header(kStart_ns, "lidar");
    sizes.Unsigned(size);
    sizes.Unsigned(size);
    std::string bytes = good;
    bytes.replace(0, sizes.bytes().size(), sizes.bytes());
    ASSERT_GT(sizes.bytes().size(), at);
    expect_fault(bytes, "field 'data': it is shorter than height, width and the steps say");
  }
}

TEST_P(RosMessageTest, EveryCutAndFlippedByteOfACloudIsReadOrNamed) {
  const std::string bytes = CloudBytes(GetParam(), kStart_ns, "lidar",
                                       {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}}, VelodyneLayout());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    RosCloud cloud;
    std::string fault;
    EXPECT_FALSE(DecodeCloud(Decoded(GetParam()), bytes.substr(0, size), &cloud, &fault)) << size;
    EXPECT_THAT(fault, HasSubstr("field '")) << size;
  }
  for (const int change : {0x01, 0x80, 0xff}) {
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      std::string flipped = bytes, fault;
      flipped[i] = static_cast<char>(flipped[i] ^ change);
      RosCloud cloud;
      const bool ok = DecodeCloud(Decoded(GetParam()), flipped, &cloud, &fault);
      EXPECT_EQ(ok, fault.empty()) << i;
    }
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
