#include "plumbline/apps/report/calibration_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(CalibrationReportTest, NamesCombine) {
  CalibrationOptions options;
  ASSERT_TRUE(ParseCalibration("", &options).ok());
  EXPECT_FALSE(options.IsOn());
  ASSERT_TRUE(ParseCalibration("mounting,odometry_scale", &options).ok());
  EXPECT_TRUE(options.laser_mounting);
  EXPECT_TRUE(options.odometry_scale);
  EXPECT_FALSE(options.range_bias);
  EXPECT_FALSE(options.range_scale);
  options = CalibrationOptions();
  ASSERT_TRUE(ParseCalibration("range_scale,range_bias", &options).ok());
  EXPECT_TRUE(options.range_bias);
  EXPECT_TRUE(options.range_scale);
  EXPECT_FALSE(options.laser_mounting);
}

TEST(CalibrationReportTest, ANameThatComesTwiceIsRefused) {
  CalibrationOptions options;
  EXPECT_EQ(ParseCalibration("mounting,range_bias,mounting", &options).message(),
            "'mounting' comes twice");
  EXPECT_FALSE(options.IsOn());
}

TEST(CalibrationReportTest, UnknownNamesAreNamed) {
  for (const char* names : {"mounting,clock", "clock", "mounting, clock", "mounting,,range_bias"}) {
    CalibrationOptions options;
    const Status status = ParseCalibration(names, &options);
    ASSERT_FALSE(status.ok()) << names;
    EXPECT_THAT(status.message(), HasSubstr("is nothing to calibrate; known are mounting "));
    EXPECT_FALSE(options.IsOn());
  }
  CalibrationOptions options;
  EXPECT_THAT(ParseCalibration("mounting,clock", &options).message(), HasSubstr("'clock'"));
}

Calibration SomeCalibration() {
  Calibration calibration;
  calibration.parameters = {{"mounting_x_m", 0.1, 0.0512, 0.0021, 0.1},
                            {"range_scale", 1.0, 1.0007, 0.0098, 0.01}};
  calibration.steps = 4;
  calibration.settled = true;
  return calibration;
}

TEST(CalibrationReportTest, Text) {
  const std::string text = CalibrationText(SomeCalibration());
  EXPECT_THAT(text, HasSubstr("  mounting_x_m          0.1000    0.0512    0.0021\n"));
  EXPECT_THAT(text, HasSubstr("0.0098  not determined by the data\n"));
  EXPECT_THAT(text, HasSubstr("settled after 4 steps"));
  EXPECT_THAT(text, Not(HasSubstr("not settled")));
  EXPECT_EQ(CalibrationText(Calibration()), "");
}

TEST(CalibrationReportTest, JsonHasEveryFigure) {
  const Json json = CalibrationJson(SomeCalibration());
  EXPECT_EQ(json["parameters"]["mounting_x_m"]["value"], 0.0512);
  EXPECT_EQ(json["parameters"]["mounting_x_m"]["given"], 0.1);
  EXPECT_EQ(json["parameters"]["mounting_x_m"]["determined"], true);
  EXPECT_EQ(json["parameters"]["range_scale"]["sigma"], 0.0098);
  EXPECT_EQ(json["parameters"]["range_scale"]["prior_sigma"], 0.01);
  EXPECT_EQ(json["parameters"]["range_scale"]["determined"], false);
  EXPECT_EQ(json["steps"], 4);
  EXPECT_EQ(json["settled"], true);
  EXPECT_TRUE(CalibrationJson(Calibration()).is_null());
}

}  // namespace
}  // namespace plumbline
