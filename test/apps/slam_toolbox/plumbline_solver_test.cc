// The scan solver for slam_toolbox, called in the orders in which slam_toolbox calls it.
#include "plumbline/apps/slam_toolbox/plumbline_solver.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include "plumbline/test/apps/slam_toolbox/simulated_mapper.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

constexpr int kOnceRound = 125;

std::shared_ptr<rclcpp_lifecycle::LifecycleNode> Host() {
  return std::make_shared<rclcpp_lifecycle::LifecycleNode>();
}

// Two computations on the way, as after two loops.
void MapTheHall(SimulatedMapper* mapper) {
  mapper->Drive(70);
  EXPECT_EQ(mapper->CorrectPoses(), 70);
  mapper->Drive(kOnceRound - 70);
  mapper->Link(4, kOnceRound - 1);
  EXPECT_EQ(mapper->CorrectPoses(), kOnceRound);
}

TEST(JointScanSolverTest, ScansMakeTheMapBetterThanConstraintsDo) {
  JointScanSolver solver;
  solver.Configure(Host());
  SimulatedMapper mapper(&solver);
  mapper.RegisterLaser();
  MapTheHall(&mapper);
  EXPECT_TRUE(solver.status().ok()) << solver.status().message();
  EXPECT_LT(mapper.Error(), 0.01);
  EXPECT_GT(mapper.ErrorOfPoseGraph(), 3.0 * mapper.Error());
}

TEST(JointScanSolverTest, FalseClosuresDoNotBendTheMap) {
  JointScanSolver solver;
  SimulatedMapper mapper(&solver);
  mapper.RegisterLaser();
  mapper.Drive(70);
  mapper.Link(5, 60, {1.5, -1.0, 0.3});
  mapper.CorrectPoses();
  mapper.Drive(kOnceRound - 70);
  mapper.Link(4, kOnceRound - 1);
  mapper.Link(30, 100, {-2.0, 0.5, 0.1});
  mapper.CorrectPoses();
  EXPECT_LT(mapper.Error(), 0.02);
  EXPECT_GT(mapper.ErrorOfPoseGraph(), 10.0 * mapper.Error());
}

TEST(JointScanSolverTest, CorrectionsLastUntilTheyAreCleared) {
  JointScanSolver solver;
  SimulatedMapper mapper(&solver);
  mapper.RegisterLaser();
  solver.Compute();
  EXPECT_TRUE(solver.GetCorrections().empty());
  mapper.Drive(3);
  solver.Compute();
  ASSERT_EQ(solver.GetCorrections().size(), 3u);
  for (int id = 0; id < 3; ++id) EXPECT_EQ(solver.GetCorrections()[id].first, id);
  solver.Clear();
  EXPECT_TRUE(solver.GetCorrections().empty());
  EXPECT_EQ(mapper.CorrectPoses(), 3);
}

TEST(JointScanSolverTest, TheLaserOfASavedMapMayComeAfterItsNodes) {
  JointScanSolver mapping, loading;
  SimulatedMapper mapper(&mapping);
  mapper.RegisterLaser();
  mapper.Drive(kOnceRound);
  mapper.Link(4, kOnceRound - 1);
  mapper.UnregisterLaser();

  mapper.HandOver(&loading);
  mapper.RegisterLaser();
  EXPECT_EQ(mapper.CorrectPoses(), kOnceRound);
  EXPECT_TRUE(loading.status().ok()) << loading.status().message();
  EXPECT_LT(mapper.Error(), 0.01);

  mapper.Drive(5);
  EXPECT_EQ(mapper.CorrectPoses(), kOnceRound + 5);
  EXPECT_LT(mapper.Error(), 0.01);
}

TEST(JointScanSolverTest, WithoutItsLaserAScanWaits) {
  JointScanSolver solver;
  SimulatedMapper mapper(&solver, "late");
  mapper.Drive(kOnceRound);
  mapper.Link(4, kOnceRound - 1);
  const double by_constraints_m = mapper.ErrorOfPoseGraph();
  EXPECT_EQ(mapper.CorrectPoses(), kOnceRound);
  EXPECT_THAT(solver.status().message(), HasSubstr("125 scans wait"));
  EXPECT_THAT(solver.status().message(), HasSubstr("laser late"));
  EXPECT_NEAR(mapper.Error(), by_constraints_m, 1e-6);

  mapper.RegisterLaser();
  EXPECT_EQ(mapper.CorrectPoses(), kOnceRound);
  EXPECT_TRUE(solver.status().ok()) << solver.status().message();
  EXPECT_LT(mapper.Error(), 0.01);
}

// In localisation the oldest of the newest scans goes as another one comes.
TEST(JointScanSolverTest, LocalisationAddsAndRemovesNodes) {
  JointScanSolver solver;
  SimulatedMapper mapper(&solver);
  mapper.RegisterLaser();
  MapTheHall(&mapper);
  for (int id = kOnceRound; id < kOnceRound + 20; ++id) {
    mapper.Drive(1);
    mapper.Link(id - 120, id);
    if (id >= kOnceRound + 5) mapper.Remove(id - 5);
    if (id % 10 == 0) {
      EXPECT_EQ(mapper.CorrectPoses(), mapper.num_nodes());
    }
  }
  EXPECT_EQ(mapper.num_nodes(), kOnceRound + 5);
  EXPECT_EQ(mapper.CorrectPoses(), kOnceRound + 5);
  EXPECT_TRUE(solver.status().ok()) << solver.status().message();
  EXPECT_LT(mapper.Error(), 0.01);
  EXPECT_EQ(solver.getGraph()->count(kOnceRound + 3), 0u);
}

TEST(JointScanSolverTest, ANodeThatGoesBeforeAComputationIsNotAskedForItsLaser) {
  JointScanSolver solver;
  SimulatedMapper mapper(&solver);
  mapper.Drive(4);
  for (int id = 0; id < 3; ++id) mapper.Remove(id);
  mapper.RegisterLaser();
  EXPECT_EQ(mapper.CorrectPoses(), 1);
  EXPECT_TRUE(solver.status().ok()) << solver.status().message();
}

// Lifelong mapping removes any node. Here that leaves two parts, which the scans alone hold
// together.
TEST(JointScanSolverTest, ScansHoldPartsWithoutConstraintsBetweenThem) {
  JointScanSolver solver;
  SimulatedMapper mapper(&solver);
  mapper.RegisterLaser();
  MapTheHall(&mapper);
  for (const int id : {0, 40, 41, 90}) mapper.Remove(id);
  EXPECT_EQ(mapper.CorrectPoses(), kOnceRound - 4);
  EXPECT_TRUE(solver.status().ok()) << solver.status().message();
  EXPECT_LT(mapper.Error(), 0.01);
}

TEST(JointScanSolverTest, NodesThatAUserMovesStartFromThere) {
  JointScanSolver solver;
  SimulatedMapper mapper(&solver);
  mapper.RegisterLaser();
  MapTheHall(&mapper);
  const Pose2 before = mapper.PoseOf(60);
  double yaw = 9.0;
  solver.GetNodeOrientation(60, yaw);
  EXPECT_NEAR(NormalizeAngle(yaw - before.yaw), 0.0, 1e-12);
  solver.ModifyNode(60, {before.x + 0.2, before.y - 0.1, 0.05});
  const Eigen::Vector3d moved = solver.getGraph()->at(60);
  EXPECT_NEAR(moved.x(), before.x + 0.2, 1e-12);
  EXPECT_NEAR(moved.y(), before.y - 0.1, 1e-12);
  EXPECT_NEAR(NormalizeAngle(moved.z() - before.yaw), 0.05, 1e-12);
  EXPECT_EQ(mapper.CorrectPoses(), kOnceRound);
  EXPECT_LT(mapper.Error(), 0.01);

  yaw = 9.0;
  solver.GetNodeOrientation(4000, yaw);
  EXPECT_EQ(yaw, 9.0);
  EXPECT_TRUE(solver.status().ok()) << solver.status().message();
  solver.ModifyNode(4000, {0.0, 0.0, 0.0});
  EXPECT_THAT(solver.status().message(), HasSubstr("node 4000"));
  solver.ModifyNode(60, {std::nan(""), 0.0, 0.0});
  EXPECT_THAT(solver.status().message(), HasSubstr("node 60"));
}

TEST(JointScanSolverTest, AResetSolverTakesAnotherMap) {
  JointScanSolver solver;
  {
    SimulatedMapper mapper(&solver);
    mapper.Drive(30);
  }
  solver.Reset();
  EXPECT_TRUE(solver.getGraph()->empty());
  solver.Compute();
  EXPECT_TRUE(solver.GetCorrections().empty());
  EXPECT_TRUE(solver.status().ok()) << solver.status().message();
  SimulatedMapper mapper(&solver);
  mapper.RegisterLaser();
  MapTheHall(&mapper);
  EXPECT_LT(mapper.Error(), 0.01);
}

TEST(JointScanSolverTest, BadInputIsReportedAndLeftOut) {
  JointScanSolver solver;
  SimulatedMapper mapper(&solver);
  mapper.RegisterLaser();
  solver.AddNode(nullptr);
  solver.AddConstraint(nullptr);
  solver.RemoveNode(7);
  solver.RemoveConstraint(7, 8);
  EXPECT_TRUE(solver.status().ok());
  mapper.Drive(10);

  karto::LocalizedRangeScan lost(karto::Name("laser"), {1.0, 2.0});
  lost.SetUniqueId(77);
  lost.SetCorrectedPose(karto::Pose2(std::nan(""), 0.0, 0.0));
  karto::Vertex<karto::LocalizedRangeScan> vertex(&lost);
  solver.AddNode(&vertex);
  EXPECT_THAT(solver.status().message(), HasSubstr("node 77"));

  const auto link = [&](karto::Vertex<karto::LocalizedRangeScan>* to, double variance) {
    karto::Matrix3 covariance;
    for (int i = 0; i < 3; ++i) covariance(i, i) = variance;
    karto::Edge<karto::LocalizedRangeScan> edge(mapper.vertex(3), to);
    edge.SetLabel(new karto::LinkInfo(karto::Pose2(), karto::Pose2(0.1, 0.0, 0.0), covariance));
    solver.AddConstraint(&edge);
    return solver.status().message();
  };
  EXPECT_THAT(link(&vertex, 1e-4), HasSubstr("node 77 is not in the map"));
  EXPECT_THAT(link(mapper.vertex(4), 0.0), HasSubstr("constraint 3 -> 4"));
  EXPECT_THAT(link(mapper.vertex(3), 1e-4), HasSubstr("constraint 3 -> 3"));
  EXPECT_EQ(mapper.CorrectPoses(), 10);
  EXPECT_TRUE(solver.status().ok()) << solver.status().message();
}

TEST(JointScanSolverTest, ParametersAreDeclaredWithTheDefaultsOfTheLibrary) {
  JointScanSolver solver;
  const auto host = Host();
  solver.Configure(host);
  const SolverOptions defaults;
  const auto declared = [&](const std::string& name) {
    return host->get_parameter("plumbline." + name);
  };
  EXPECT_EQ(declared("sigma_range_m").as_double(), defaults.factors.beam.sigma_range_m);
  EXPECT_EQ(declared("sigma_bearing_rad").as_double(), defaults.factors.beam.sigma_bearing_rad);
  EXPECT_EQ(declared("sigma_manifold_m").as_double(), defaults.factors.manifold.sigma_m);
  EXPECT_EQ(declared("test_edges").as_bool(), defaults.test_edges);
  EXPECT_EQ(declared("threads").as_int(), defaults.num_threads);
  EXPECT_TRUE(solver.status().ok());
}

TEST(JointScanSolverTest, ParametersOfTheHostAreTaken) {
  // What nobody would measure shows that it is taken: ranges that are worth nothing.
  const auto error_at = [](double sigma_range_m) {
    JointScanSolver solver;
    const auto host = Host();
    host->declare_parameter("plumbline.sigma_range_m", rclcpp::ParameterValue(sigma_range_m));
    solver.Configure(host);
    EXPECT_TRUE(solver.status().ok());
    SimulatedMapper mapper(&solver);
    mapper.RegisterLaser();
    MapTheHall(&mapper);
    return mapper.Error();
  };
  EXPECT_GT(error_at(10.0), 3.0 * error_at(0.01));
}

TEST(JointScanSolverTest, ParametersOutOfRangeAreReported) {
  JointScanSolver solver;
  const auto host = Host();
  host->declare_parameter("plumbline.threads", rclcpp::ParameterValue(std::int64_t{0}));
  solver.Configure(host);
  EXPECT_THAT(solver.status().message(), HasSubstr("num_threads = 0"));
  SimulatedMapper mapper(&solver);
  mapper.RegisterLaser();
  mapper.Drive(3);
  EXPECT_EQ(mapper.CorrectPoses(), 3);
  EXPECT_TRUE(solver.status().ok()) << solver.status().message();
}

}  // namespace
}  // namespace plumbline
