#include "plumbline/apps/program/log_flags.h"

#include <gflags/gflags.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/apps/program/command_line.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

TEST(LogFlagsTest, FlagsAreTheOptionsOfTheReader) {
  const gflags::FlagSaver saver;
  EXPECT_EQ(LogReadOptionsFromFlags().bag.scan_topic, "");
  EXPECT_EQ(LogReadOptionsFromFlags().bag.odom_topic, "");
  EXPECT_EQ(LogReadOptionsFromFlags().bag.odom_frame, "odom");
  gflags::SetCommandLineOption("scan_topic", "/front");
  gflags::SetCommandLineOption("odom_topic", "/wheels");
  gflags::SetCommandLineOption("odom_frame", "start");
  EXPECT_EQ(LogReadOptionsFromFlags().bag.scan_topic, "/front");
  EXPECT_EQ(LogReadOptionsFromFlags().bag.odom_topic, "/wheels");
  EXPECT_EQ(LogReadOptionsFromFlags().bag.odom_frame, "start");
  gflags::SetCommandLineOption("laser_frame", "front_laser");
  gflags::SetCommandLineOption("clock", "record");
  gflags::SetCommandLineOption("beam_direction", "upside_down");
  gflags::SetCommandLineOption("fov_deg", "90");
  const LogReadOptions options = LogReadOptionsFromFlags();
  EXPECT_EQ(options.laser_frame, "front_laser");
  EXPECT_EQ(options.clock, RosClock::kRecord);
  EXPECT_EQ(options.beam_direction, BeamDirection::kUpsideDown);
  EXPECT_NEAR(options.flaser_fov_rad.value(), 0.5 * kPi, 1e-15);
  EXPECT_EQ(gflags::SetCommandLineOption("clock", "wall"), "");
  EXPECT_EQ(gflags::SetCommandLineOption("beam_direction", "left"), "");
  EXPECT_EQ(gflags::SetCommandLineOption("fov_deg", "400"), "");
}

TEST(LogFlagsTest, ASweepTimeIsTakenFromZeroToAMinute) {
  const gflags::FlagSaver saver;
  EXPECT_EQ(SweepTimeFromFlags(), std::nullopt);
  gflags::SetCommandLineOption("sweep_time_s", "0.15");
  EXPECT_EQ(SweepTimeFromFlags(), 0.15);
  for (const char* value : {"61", "inf", "nan"}) {
    EXPECT_EQ(gflags::SetCommandLineOption("sweep_time_s", value), "") << value;
  }
  EXPECT_EQ(SweepTimeFromFlags(), 0.15);
  gflags::SetCommandLineOption("sweep_time_s", "-2");
  EXPECT_EQ(SweepTimeFromFlags(), std::nullopt);
}

TEST(LogFlagsTest, HelpListsThem) {
  EXPECT_THAT(HelpText("usage"), testing::AllOf(testing::HasSubstr("--scan_topic="),
                                                testing::HasSubstr("--odom_topic="),
                                                testing::HasSubstr("--odom_frame=odom")));
}

}  // namespace
}  // namespace plumbline
