#include "plumbline/apps/program/log_flags.h"

#include <gflags/gflags.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "plumbline/apps/program/command_line.h"

namespace plumbline {
namespace {

TEST(LogFlagsTest, FlagsAreTheOptionsOfTheReader) {
  const gflags::FlagSaver saver;
  EXPECT_EQ(BagReadOptionsFromFlags().scan_topic, "");
  EXPECT_EQ(BagReadOptionsFromFlags().odom_topic, "");
  EXPECT_EQ(BagReadOptionsFromFlags().odom_frame, "odom");
  gflags::SetCommandLineOption("scan_topic", "/front");
  gflags::SetCommandLineOption("odom_topic", "/wheels");
  gflags::SetCommandLineOption("odom_frame", "start");
  EXPECT_EQ(BagReadOptionsFromFlags().scan_topic, "/front");
  EXPECT_EQ(BagReadOptionsFromFlags().odom_topic, "/wheels");
  EXPECT_EQ(BagReadOptionsFromFlags().odom_frame, "start");
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
