#include "plumbline/apps/benchmark/online_day.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace plumbline {
namespace {

using testing::HasSubstr;

TEST(OnlineDayTest, IsLocalisedWhileItDrives) {
  OnlineDayOptions options;
  options.hours = 0.01;
  options.is_localised = true;
  OnlineDay day;
  const Status status = RunOnlineDay(MapLogOptions(), options, {}, &day);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(day.num_scans, 360);
  EXPECT_NEAR(day.recorded_s, 36.0, 1e-9);
  ASSERT_GT(day.error_m.size(), 300u);
  EXPECT_LT(*std::max_element(day.error_m.begin(), day.error_m.end()), 0.2);
  EXPECT_EQ(day.add_ms.size(), 360u);
  EXPECT_EQ(day.lag_s.size(), 360u);
  EXPECT_THAT(OnlineDayTable(day), HasSubstr("360 scans of 36.0 s"));
}

}  // namespace
}  // namespace plumbline
