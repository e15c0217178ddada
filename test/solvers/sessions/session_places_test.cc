#include "plumbline/solvers/sessions/session_places.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <utility>
#include <vector>

#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/seeding/seed_drive.h"
#include "plumbline/solvers/sessions/session_set.h"

namespace plumbline {
namespace {

TEST(ReversedTest, IsTheSameMeasurementFromTheOtherEnd) {
  RelativePoseConstraint edge{3, 7, Pose2(1.5, -0.7, 0.9)};
  edge.covariance << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  const RelativePoseConstraint reversed = Reversed(edge);
  EXPECT_EQ(reversed.from, 7);
  EXPECT_EQ(reversed.to, 3);
  const Pose2 none = edge.from_from_to * reversed.from_from_to;
  EXPECT_LT(none.translation().norm() + std::abs(none.yaw), 1e-12);
  // The inverse of a motion that is a little off.
  constexpr double kStep = 1e-6;
  Eigen::Matrix3d jacobian;
  for (int i = 0; i < 3; ++i) {
    Pose2 moved = edge.from_from_to;
    (i == 0 ? moved.x : i == 1 ? moved.y : moved.yaw) += kStep;
    const Pose2 inverse = moved.Inverse();
    jacobian.col(i) =
        Eigen::Vector3d(inverse.x - reversed.from_from_to.x, inverse.y - reversed.from_from_to.y,
                        inverse.yaw - reversed.from_from_to.yaw) /
        kStep;
  }
  const Eigen::Matrix3d covariance = jacobian * edge.covariance * jacobian.transpose();
  EXPECT_LT((reversed.covariance - covariance).norm(), 1e-6);
}

TEST(ReversedTest, TwiceIsTheEdgeItself) {
  RelativePoseConstraint edge{0, 1, Pose2(-0.4, 2.0, -2.5)};
  edge.covariance << 0.02, 0.001, 0.0, 0.001, 0.05, 0.003, 0.0, 0.003, 0.02;
  const RelativePoseConstraint twice = Reversed(Reversed(edge));
  EXPECT_EQ(twice.from, edge.from);
  EXPECT_NEAR(twice.from_from_to.x, edge.from_from_to.x, 1e-12);
  EXPECT_NEAR(twice.from_from_to.y, edge.from_from_to.y, 1e-12);
  EXPECT_NEAR(twice.from_from_to.yaw, edge.from_from_to.yaw, 1e-12);
  EXPECT_LT((twice.covariance - edge.covariance).norm(), 1e-12);
}

class SessionPlacesTest : public testing::Test {
 protected:
  // Two drives through one building.
  void SetUp() override {
    for (const int visit : {0, 1}) {
      SimulationOptions options;
      options.seed = visit;
      options.scan_period_s = 1.0;
      SimulatedLog log;
      ASSERT_TRUE(
          Simulate(World(GenerateVisit(BuildingKind::kRandom, 1, visit)), options, &log).ok());
      SlamGraph graph;
      ASSERT_TRUE(MakeGraph(log, &graph).ok());
      SeededDrive drive;
      SeedingReport report;
      ASSERT_TRUE(SeedDrive(SeedingOptions(), MotionOptions(),
                            MeasureSurface(graph, NormalOptionsFor(RangeBeamOptions()), &pool_),
                            nullptr, &pool_, graph, &drive, &report)
                      .ok());
      ASSERT_TRUE(AddSession(graph, std::move(drive), &set_).ok());
    }
    FinishSet(&pool_, &set_);
  }

  ThreadPool pool_{2};
  SessionSet set_;
};

TEST_F(SessionPlacesTest, AreFoundOnceAndGivenFromEitherEnd) {
  int num_calls = 0;
  const SeedingProgress count = [&num_calls](SeedingPhase, int, int) { return ++num_calls > 0; };
  const SessionGroup a = GroupOfOne(set_, 0), b = GroupOfOne(set_, 1);
  SessionPlaces places(set_, &pool_);
  std::vector<TestedCandidate> of_b, of_a;
  ASSERT_TRUE(places.Find(a, b, count, &of_b).ok());
  ASSERT_GT(of_b.size(), 5u);
  const int calls_of_search = num_calls;
  EXPECT_GT(calls_of_search, 0);
  ASSERT_TRUE(places.Find(b, a, count, &of_a).ok());
  EXPECT_EQ(num_calls, calls_of_search);
  ASSERT_EQ(of_a.size(), of_b.size());
  for (std::size_t i = 0; i < of_b.size(); ++i) {
    EXPECT_LT(of_b[i].edge.from, a.keys.size());
    EXPECT_GE(of_b[i].edge.to, a.keys.size());
    EXPECT_EQ(of_a[i].edge.from, of_b[i].edge.to - a.keys.size());
    EXPECT_EQ(of_a[i].edge.to, of_b[i].edge.from + b.keys.size());
    const Pose2 none = of_b[i].edge.from_from_to * of_a[i].edge.from_from_to;
    EXPECT_LT(none.translation().norm() + std::abs(none.yaw), 1e-9);
  }
}

TEST_F(SessionPlacesTest, TheirCallerStopsThem) {
  SessionPlaces places(set_, &pool_);
  std::vector<TestedCandidate> found;
  const Status stopped = places.Find(
      GroupOfOne(set_, 0), GroupOfOne(set_, 1), [](SeedingPhase, int, int) { return false; },
      &found);
  EXPECT_EQ(stopped.code(), StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
