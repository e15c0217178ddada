#include "plumbline/solvers/terms/term_of.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace plumbline {
namespace {

using testing::ElementsAre;

// A term that is all here: headings of poses, robust.
struct HeadingResidual {
  double yaw_rad = 0.0;

  bool Evaluate(const double* pose, double* residual, double* d_pose) const {
    residual[0] = 10.0 * (pose[2] - yaw_rad);
    if (d_pose != nullptr) d_pose[0] = d_pose[1] = 0.0, d_pose[2] = 10.0;
    return std::isfinite(residual[0]);
  }
};
using HeadingFactor = AnalyticFactor<HeadingResidual, 1, 3>;

class HeadingTerm final : public TermOf<HeadingTerm, HeadingFactor, PoseId> {
 public:
  std::string name() const override { return "heading"; }
  std::size_t num_blocks() const override { return 2; }
  GemanMcClure loss() const { return GemanMcClure::FromGate(3.0); }

  template <typename Visit>
  bool ForEach(int /*scan*/, const double* /*poses*/, const Visit& visit) const {
    return visit(0, HeadingResidual{0.5}, PoseId{0}) && visit(1, HeadingResidual{1.0}, PoseId{2});
  }
};

struct Equations final : PoseEquations {
  void Add(int pose, const Eigen::Matrix3d& block, const Eigen::Vector3d& by_pose) override {
    blocks[pose] += block(2, 2);
    gradient[pose] += by_pose.z();
  }
  void AddCoupling(int, int, const Eigen::Matrix3d&) override { ADD_FAILURE(); }

  std::vector<double> blocks = std::vector<double>(3), gradient = std::vector<double>(3);
};

const std::vector<double> kPoses = {1.0, 2.0, 0.6, 0.0, 0.0, 0.0, 3.0, 4.0, 0.7};  // off: 1, -3

TEST(TermOfTest, ARobustTermOnPosesIsTheSameInEveryForm) {
  const HeadingTerm term;
  EXPECT_EQ(term.residuals_per_block(), 1);
  EXPECT_TRUE(term.SeesPoses());
  EXPECT_FALSE(term.SeesPoints() || term.JoinsPoints() || term.GoesByScan() || term.RidesAlong());
  const StateView at{kPoses.data(), nullptr};
  std::vector<double> residuals(2), gradient(9), blocks(18);
  term.Evaluate(Term::kNoScan, at, residuals.data());
  EXPECT_NEAR(residuals[0], 1.0, 1e-12);
  EXPECT_NEAR(residuals[1], -3.0, 1e-12);

  double cost = 0.0, squares = 0.0;
  TermDerivatives out;
  out.pose_gradient = gradient.data();
  out.pose_blocks = blocks.data();
  ASSERT_TRUE(term.Linearize(Term::kNoScan, at, out, &cost));
  term.AddSquares(kPoses.data(), &squares);
  // rho(s) = 9 s / (9 + s) of 1 and 9.
  EXPECT_NEAR(cost, 0.5 * (0.9 + 4.5), 1e-12);
  EXPECT_NEAR(squares, 2.0 * cost, 1e-12);

  Equations equations;
  term.AddEquations(kPoses.data(), &equations);
  std::vector<double> direction(9, 1.0);
  double curvature = 0.0;
  term.AddCurvature(Term::kNoScan, at, {direction.data(), nullptr}, &curvature);
  for (const int pose : {0, 2}) {
    EXPECT_NEAR(equations.gradient[pose], gradient[3 * pose + 2], 1e-12) << pose;
    EXPECT_NEAR(equations.blocks[pose], blocks[6 * pose + 5], 1e-12) << pose;
  }
  EXPECT_NEAR(gradient[8], -30.0 * 0.25, 1e-12);
  EXPECT_NEAR(curvature, blocks[5] + blocks[17], 1e-12);
}

TEST(TermOfTest, IsAResidualOfCeres) {
  const HeadingTerm term;
  std::vector<double> poses = kPoses;
  const auto loss = term.MakeLoss();
  std::vector<ceres::ResidualBlockId> ids;
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(options);
  TermProblem to{&problem, loss.get(), poses.data(), nullptr, &ids};
  term.AddTo(Term::kNoScan, &to);
  EXPECT_EQ(ids.size(), 2u);
  double cost = 0.0;
  ASSERT_TRUE(problem.Evaluate({}, &cost, nullptr, nullptr, nullptr));
  EXPECT_NEAR(cost, 0.5 * (0.9 + 4.5), 1e-12);
}

TEST(TermOfTest, AResidualOfOnePoseTiesItToTheWorld) {
  PoseSets sets(3);
  std::vector<char> tied(3, false);
  HeadingTerm().TiePoses(&sets, &tied);
  EXPECT_THAT(tied, ElementsAre(true, false, true));
  EXPECT_NE(sets.Find(0), sets.Find(2));
}

TEST(TermOfTest, WhatIsUndefinedIsNotANumber) {
  std::vector<double> poses = kPoses;
  poses[2] = std::numeric_limits<double>::infinity();
  const StateView at{poses.data(), nullptr};
  double cost = 0.0, squares = 0.0;
  std::vector<double> residuals(2);
  EXPECT_FALSE(HeadingTerm().Linearize(Term::kNoScan, at, {}, &cost));
  HeadingTerm().AddSquares(poses.data(), &squares);
  EXPECT_TRUE(std::isnan(squares));
  HeadingTerm().Evaluate(Term::kNoScan, at, residuals.data());
  EXPECT_TRUE(std::isnan(residuals[0]));
  EXPECT_NEAR(residuals[1], -3.0, 1e-12);
}

}  // namespace
}  // namespace plumbline
