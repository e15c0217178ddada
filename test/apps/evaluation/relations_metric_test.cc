#include "plumbline/apps/evaluation/relations_metric.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/core/angle.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

Relation MakeRelation(double from_s, double to_s, double x, double y, double yaw_deg) {
  return {from_s, to_s, {x, y, DegToRad(yaw_deg)}};
}

// One metre ahead, a turn to the left, and after a while two metres ahead and another such turn.
const std::vector<TimedPose> kTrajectory = {
    {20.0, {1.0, 2.0, DegToRad(180.0)}}, {0.0, {0.0, 0.0, 0.0}}, {1.0, {1.0, 0.0, DegToRad(90.0)}}};

TEST(RelationsMetricTest, FiguresWorkedByHand) {
  const RelationsMetric metric = MeasureRelations(
      {MakeRelation(0.0, 1.0, 0.7, 0.4, 80.0),      // (0.3, -0.4) m and 10 deg off
       MakeRelation(1.0, 20.0, 2.0, -1.5, -100.0),  // 1.5 m and 170 deg off, across the cut
       MakeRelation(0.0, 20.0, 1.0, 2.0, -178.0),   // 2 deg off, across the cut
       MakeRelation(0.0, 5.0, 1.0, 0.0, 0.0)},      // no pose at 5 s
      kTrajectory, RelationsOptions());

  EXPECT_EQ(metric.all.num_matched, 3u);
  EXPECT_EQ(metric.all.num_unmatched, 1u);
  const ErrorStatistics& translation = metric.all.translation_m;
  EXPECT_NEAR(translation.mean, 2.0 / 3.0, 1e-12);
  EXPECT_NEAR(translation.std, std::sqrt(21.0) / 6.0, 1e-12);
  EXPECT_NEAR(translation.rmse, std::sqrt(2.5 / 3.0), 1e-12);
  EXPECT_NEAR(translation.median, 0.5, 1e-12);
  EXPECT_NEAR(translation.p95, 0.5, 1e-12);
  EXPECT_NEAR(translation.max, 1.5, 1e-12);
  const ErrorStatistics& rotation = metric.all.rotation_deg;
  EXPECT_NEAR(rotation.mean, 182.0 / 3.0, 1e-10);
  EXPECT_NEAR(rotation.median, 10.0, 1e-10);
  EXPECT_NEAR(rotation.max, 170.0, 1e-10);

  EXPECT_EQ(metric.local.num_matched, 1u);
  EXPECT_EQ(metric.local.num_unmatched, 1u);
  EXPECT_NEAR(metric.local.translation_m.mean, 0.5, 1e-12);
  EXPECT_EQ(metric.local.translation_m.std, 0.0);
  EXPECT_EQ(metric.revisits.num_matched, 2u);
  EXPECT_EQ(metric.revisits.num_unmatched, 0u);
  EXPECT_NEAR(metric.revisits.translation_m.std, std::sqrt(2.0 * 0.75 * 0.75), 1e-12);
  EXPECT_NEAR(metric.revisits.translation_m.median, 1.5, 1e-12);
  EXPECT_NEAR(metric.revisits.translation_m.p95, 0.0, 1e-12);
}

TEST(RelationsMetricTest, TheSpanIsLocalUpToItsEndEitherWayInTime) {
  const std::vector<Relation> relations = {MakeRelation(1.0, 20.0, 2.0, 0.0, 90.0),
                                           MakeRelation(20.0, 1.0, 0.0, 0.0, 0.0)};
  RelationsOptions options;
  options.local_span_s = 19.0;
  EXPECT_EQ(MeasureRelations(relations, kTrajectory, options).local.num_matched, 2u);
  options.local_span_s = 18.9;
  EXPECT_EQ(MeasureRelations(relations, kTrajectory, options).revisits.num_matched, 2u);
}

TEST(RelationsMetricTest, TakesTheNearestPoseWithinTheTolerance) {
  RelationsOptions options;
  options.tolerance_s = 0.5;
  // 0.5 s is equally near to 0 s and 1 s: the earlier one counts.
  const RelationsMetric metric =
      MeasureRelations({MakeRelation(0.5, 19.5, 1.0, 2.0, 180.0)}, kTrajectory, options);
  EXPECT_EQ(metric.all.num_matched, 1u);
  EXPECT_NEAR(metric.all.translation_m.mean, 0.0, 1e-12);
  options.tolerance_s = 0.49;
  EXPECT_EQ(MeasureRelations({MakeRelation(0.5, 20.0, 1.0, 2.0, 180.0)}, kTrajectory, options)
                .all.num_unmatched,
            1u);
}

TEST(RelationsMetricTest, NothingMatchedHasNoFigures) {
  const RelationsMetric metric = MeasureRelations({}, kTrajectory, RelationsOptions());
  EXPECT_EQ(metric.all.num_matched, 0u);
  EXPECT_TRUE(std::isnan(metric.all.translation_m.mean));
}

TEST(RelationsMetricTest, ReadsRelations) {
  const std::string path = TempFolder() + "a.relations";
  WriteFile(path, "# t1 t2 x y z roll pitch yaw\n\n1.5 2.5 3 -4 9 0.1 0.2 0.5\r\n");
  std::vector<Relation> relations;
  const Status status = ReadRelations(path, &relations);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(relations.size(), 1u);
  EXPECT_EQ(relations[0].from_s, 1.5);
  EXPECT_EQ(relations[0].to_s, 2.5);
  EXPECT_EQ(relations[0].from_from_to.x, 3.0);
  EXPECT_EQ(relations[0].from_from_to.y, -4.0);
  EXPECT_EQ(relations[0].from_from_to.yaw, 0.5);
}

TEST(RelationsMetricTest, ErrorsNameFileLineAndField) {
  const std::string path = TempFolder() + "a.relations";
  const auto read = [&path](const std::string& content) {
    WriteFile(path, content);
    std::vector<Relation> relations(1);
    const Status status = ReadRelations(path, &relations);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(relations.size(), 1u);  // Untouched.
    return status.message();
  };
  EXPECT_EQ(read("1 2 3 4 0 0 0 1\n1 2 x 4 0 0 0 1\n"),
            path + ":2: field 'x': 'x' is not a number");
  EXPECT_EQ(read("1 2 3 4 0 0 0\n"), path + ":1: field 'yaw': is missing, the line ends before it");
  EXPECT_EQ(read("1 2 3 4 0 0 0 1 7\n"),
            path + ":1: field 'end of line': '7' is one field too many");
  EXPECT_EQ(read("nan 2 3 4 0 0 0 1\n"), path + ":1: field 't1': 'nan' is not a finite number");
  EXPECT_EQ(read("# nothing\n"), path + ": no relation");
  std::vector<Relation> relations;
  EXPECT_EQ(ReadRelations(path + "x", &relations).code(), StatusCode::kNotFound);
}

TEST(RelationsMetricTest, OptionsOutOfRangeAreNamed) {
  std::string error;
  RelationsOptions options;
  EXPECT_TRUE(options.Check(&error));
  options.tolerance_s = -1.0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_EQ(error, "tolerance_s = -1, but it must be >= 0.0");
}

// The figures that the benchmark publishes of the raw odometry of building 079, and more digits of
// them by its own evaluator's rules.
TEST(RelationsMetricTest, RawOdometryOfARealLog) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "PLUMBLINE_DATASETS is not set";
  CarmenLog log;
  Status status = ReadCarmenLog(DatasetsFolder() + "/fr079.clf.gz", CarmenReadOptions(), &log);
  ASSERT_TRUE(status.ok()) << status.message();
  std::vector<TimedPose> odometry;
  for (const CarmenScan& scan : log.scans) {
    odometry.push_back({scan.timestamp_s, scan.odom_from_robot});
  }
  std::vector<Relation> relations;
  status = ReadRelations(DatasetsFolder() + "/fr079.relations", &relations);
  ASSERT_TRUE(status.ok()) << status.message();
  const RelationsMetric metric = MeasureRelations(relations, odometry, RelationsOptions());
  EXPECT_EQ(metric.all.num_matched, 1685u);
  EXPECT_EQ(metric.local.num_matched, 987u);
  EXPECT_EQ(metric.revisits.num_matched, 698u);
  EXPECT_NEAR(metric.all.translation_m.mean, 6.5042, 5e-5);
  EXPECT_NEAR(metric.all.translation_m.std, 13.6680, 5e-5);
  EXPECT_NEAR(metric.all.rotation_deg.mean, 30.2922, 5e-5);
  EXPECT_NEAR(metric.all.rotation_deg.std, 45.5340, 5e-5);
  EXPECT_NEAR(metric.local.translation_m.median, 0.0342, 5e-5);
  EXPECT_NEAR(metric.revisits.translation_m.p95, 50.9387, 5e-5);
  EXPECT_NEAR(metric.revisits.rotation_deg.max, 178.5601, 5e-5);
}

}  // namespace
}  // namespace plumbline
