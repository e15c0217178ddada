#include "plumbline/apps/readers/implausible_readings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "plumbline/apps/program/read_log.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Scans of 100 equal readings, and of the last of them, in a laser of this maximum range.
class ImplausibleReadingsTest : public testing::Test {
 protected:
  void AddScans(int num_scans, double range_m, int num_readings = 100) {
    LaserModel laser;
    laser.num_beams = 100;
    laser.bearing_step_rad = 0.01;
    laser.max_range_m = max_range_m_;
    for (int i = 0; i < num_scans; ++i) {
      const int id = graph_.AddLaser(laser);
      const int pose = graph_.AddPose(Pose2(), time_s_);
      std::vector<double> ranges_m(100, 0.0);
      for (int beam = 0; beam < num_readings; ++beam) ranges_m[beam] = range_m;
      graph_.AddScan(pose, id, ranges_m);
      time_s_ += 0.1;
    }
  }

  double max_range_m_ = 80.0, time_s_ = 1.0;
  SlamGraph graph_;
};

TEST_F(ImplausibleReadingsTest, ARoomIsPlausible) {
  AddScans(10, 5.0);
  AddScans(10, 5.0, 0);  // outside
  AddScans(10, 5.0, 1);  // a post
  EXPECT_THAT(ImplausibleReadings(graph_), IsEmpty());
}

TEST_F(ImplausibleReadingsTest, AGraphWithoutScansIsPlausible) {
  EXPECT_THAT(ImplausibleReadings(graph_), IsEmpty());
}

TEST_F(ImplausibleReadingsTest, MillimetresBeyondTheMaximumRangeAreNoticed) {
  AddScans(2, 50.0);
  AddScans(10, 5000.0);
  EXPECT_THAT(
      ImplausibleReadings(graph_),
      ElementsAre(AllOf(HasSubstr("10 of 12 scans have next to no readings"),
                        HasSubstr("look like millimetres or centimetres, or are not positive"))));
}

TEST_F(ImplausibleReadingsTest, MillimetresWithinTheMaximumRangeAreNoticed) {
  max_range_m_ = 8000.0;
  AddScans(10, 2500.0);
  EXPECT_THAT(ImplausibleReadings(graph_),
              ElementsAre("half of the readings are above 2500 m, beyond the reach of a laser; the "
                          "ranges look like millimetres, but metres are expected"));
}

TEST_F(ImplausibleReadingsTest, CentimetresWithinTheMaximumRangeAreNoticed) {
  max_range_m_ = 8000.0;
  AddScans(10, 250.0);
  EXPECT_THAT(ImplausibleReadings(graph_), ElementsAre(HasSubstr("look like centimetres or")));
}

TEST_F(ImplausibleReadingsTest, OdometryInMillimetresIsNoticed) {
  AddScans(4, 5.0);
  for (int i = 1; i < 4; ++i) {
    graph_.AddOdometry({i - 1, i, {i == 1 ? 0.0 : 0.3, 0.0, 0.1}});
  }
  EXPECT_EQ(ImplausibleOdometry(graph_), "");
  for (int i = 1; i < 4; ++i) {
    graph_.AddOdometry({i - 1, i, {30.0, 0.0, 0.1}});
  }
  EXPECT_THAT(ImplausibleOdometry(graph_),
              AllOf(HasSubstr("30 m from one scan to the next, at 300 m/s"),
                    HasSubstr("looks like millimetres or centimetres")));
}

TEST_F(ImplausibleReadingsTest, NegativeRangesAreNoticed) {
  AddScans(10, -5.0);
  EXPECT_THAT(ImplausibleReadings(graph_), ElementsAre(HasSubstr("are not positive")));
}

TEST_F(ImplausibleReadingsTest, AMaximumRangeThatLeavesNothingIsNoticed) {
  max_range_m_ = 0.1;
  AddScans(10, 5.0);
  EXPECT_THAT(ImplausibleReadings(graph_),
              ElementsAre(AllOf(HasSubstr("0.05 m and 0.1 m"),
                                HasSubstr("the maximum range looks wrong"))));
}

TEST_F(ImplausibleReadingsTest, RealLogsGiveNoWarning) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "set PLUMBLINE_DATASETS to the folder of the logs";
  for (const char* log :
       {"acapulco.log.gz", "fr-clinic.clf.gz", "fr079-radish-4791.log.gz", "fr079.clf.gz",
        "infinite-corridor.log.gz", "intel.clf.gz", "mit-killian.clf.gz", "orebro.log.gz"}) {
    SlamGraph graph;
    LogNotes notes;
    const Status status = ReadLogIntoGraph(DatasetsFolder() + "/" + log, 0, &notes, &graph);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_THAT(ImplausibleReadings(graph), IsEmpty()) << log;
  }
}

}  // namespace
}  // namespace plumbline
