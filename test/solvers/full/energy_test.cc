#include "plumbline/solvers/full/energy.h"

#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <array>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/solvers/full/nonlinear_cg.h"
#include "plumbline/solvers/full/problem_builder.h"
#include "plumbline/solvers/terms/terms.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using Vector = std::vector<double>;
using SparseMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// A noisy room off its optimum.
NoisyRoom DisturbedRoom(int num_beams = 180) {
  NoisyRoomOptions options;
  options.num_beams = num_beams;
  NoisyRoom room = MakeNoisyRoom(options);
  DisturbPoses(0.02, room.graph, &room.state);
  DisturbPoints(0.01, &room.state);
  return room;
}

Eigen::Map<const Eigen::VectorXd> AsEigen(const Vector& v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

void ExpectClose(const Vector& actual, const Eigen::VectorXd& expected, const char* what) {
  ASSERT_EQ(static_cast<Eigen::Index>(actual.size()), expected.size()) << what;
  EXPECT_GT(expected.norm(), 0.0) << what;
  EXPECT_LE((AsEigen(actual) - expected).norm(), 1e-9 * expected.norm()) << what;
}

/// What Ceres evaluates: parameters are all poses, then all points; residuals go by term.
struct Oracle {
  Oracle(const SlamGraph& graph, const Associations& associations, const FactorOptions& factors,
         MapState* state)
      : joint(BuildJointProblem(graph, associations, factors, state)) {
    for (int p = 0; p < graph.num_poses(); ++p) {
      all.parameter_blocks.push_back(&state->poses[3 * p]);
    }
    for (std::size_t r = 0; r < graph.num_returns(); ++r) {
      all.parameter_blocks.push_back(&state->points[2 * r]);
    }
    for (const auto& blocks : joint.residual_blocks) {
      all.residual_blocks.insert(all.residual_blocks.end(), blocks.begin(), blocks.end());
    }
  }

  // As if no pose were fixed.
  void SetAllVariable() {
    for (double* block : all.parameter_blocks) joint.problem->SetParameterBlockVariable(block);
  }

  JointProblem joint;
  ceres::Problem::EvaluateOptions all;
};

void ExpectSameAsCeres(const SlamGraph& graph, const FactorOptions& factors, bool every_term,
                       MapState* state) {
  ThreadPool pool(2);
  const Associations associations = AssociationsOf(graph, *state);
  const Energy energy(graph, associations, factors, &pool);
  TermCosts costs;
  Vector pose_gradient, point_gradient;
  EnergyDerivatives derivatives;
  derivatives.pose_gradient = &pose_gradient;
  derivatives.point_gradient = &point_gradient;
  ASSERT_TRUE(energy.Evaluate(state->poses, state->points, &costs, derivatives));

  Oracle oracle(graph, associations, factors, state);
  double total = 0.0;
  Vector gradient;
  ASSERT_TRUE(oracle.joint.problem->Evaluate(oracle.all, &total, nullptr, &gradient, nullptr));
  EXPECT_NEAR(costs.Total(), total, 1e-9 * total);
  const std::size_t num_pose_entries = state->poses.size();
  ExpectClose(pose_gradient, AsEigen(gradient).head(num_pose_entries), "poses");
  ExpectClose(point_gradient, AsEigen(gradient).tail(gradient.size() - num_pose_entries), "points");
  for (const FixedPose& fixed : graph.fixed_poses()) {
    EXPECT_TRUE(AsEigen(pose_gradient).segment<3>(3 * fixed.pose).isZero(0.0)) << fixed.pose;
  }

  ASSERT_EQ(energy.terms().size(), 5u);
  ASSERT_EQ(costs.cost.size(), 5u);
  for (std::size_t t = 0; t < energy.terms().size(); ++t) {
    SCOPED_TRACE(energy.terms()[t]->name());
    const auto& blocks = oracle.joint.residual_blocks[t];
    EXPECT_EQ(blocks.size(), energy.terms()[t]->num_blocks());
    if (every_term) {
      EXPECT_GT(blocks.size(), 0u);
    }
    if (blocks.empty()) {  // which Ceres would take for "all"
      EXPECT_EQ(costs.cost[t], 0.0);
      continue;
    }
    ceres::Problem::EvaluateOptions some;
    some.residual_blocks = blocks;
    double cost = 0.0;
    ASSERT_TRUE(oracle.joint.problem->Evaluate(some, &cost, nullptr, nullptr, nullptr));
    EXPECT_NEAR(costs.cost[t], cost, 1e-9 * cost);
  }
}

/// J^T W J of all parameters, those of fixed poses too, from Ceres' uncorrected Jacobian; W = rho'
/// of the robust terms.
SparseMatrix GaussNewtonHessian(const SlamGraph& graph, const Associations& associations,
                                const FactorOptions& factors, MapState* state) {
  Oracle oracle(graph, associations, factors, state);
  oracle.SetAllVariable();
  oracle.all.apply_loss_function = false;
  Vector residuals;
  ceres::CRSMatrix crs;
  EXPECT_TRUE(oracle.joint.problem->Evaluate(oracle.all, nullptr, &residuals, nullptr, &crs));
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(crs.num_rows);
  int row = 0;
  const TermList terms = MakeTerms(graph, associations, factors);
  for (std::size_t t = 0; t < terms.size(); ++t) {
    const int size = terms[t]->residuals_per_block();
    EXPECT_EQ(size, (std::array<int, 5>{3, 3, 2, 1, 2}[t]));
    for (std::size_t b = 0; b < oracle.joint.residual_blocks[t].size(); ++b, row += size) {
      const double s = AsEigen(residuals).segment(row, size).squaredNorm();
      if (terms[t]->name() == kManifoldTerm) {
        weights.segment(row, size).setConstant(
            GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas).Weight(s));
      } else if (terms[t]->name() == "shape") {
        weights.segment(row, size).setConstant(
            GemanMcClure::FromGate(factors.ShapeGateSigmas()).Weight(s));
      }
    }
  }
  EXPECT_EQ(row, crs.num_rows);
  const SparseMatrix jacobian = Eigen::Map<const SparseMatrix>(
      crs.num_rows, crs.num_cols, static_cast<Eigen::Index>(crs.values.size()), crs.rows.data(),
      crs.cols.data(), crs.values.data());
  return SparseMatrix(jacobian.transpose()) * weights.asDiagonal() * jacobian;
}

Vector RandomVector(std::size_t size, unsigned seed) {
  RandomStates random(seed);
  Vector v(size);
  for (double& entry : v) entry = random.Gaussian(1.0);
  return v;
}

/// Upper triangles of the N x N blocks on the diagonal, from row `first` on.
Eigen::VectorXd DiagonalBlocks(const SparseMatrix& matrix, int size, int first, int num_blocks) {
  Vector values;
  for (int b = 0; b < num_blocks; ++b) {
    for (int i = 0; i < size; ++i) {
      for (int j = i; j < size; ++j) {
        values.push_back(matrix.coeff(first + b * size + i, first + b * size + j));
      }
    }
  }
  return AsEigen(values);
}

TEST(EnergyTest, CostsAndGradientsAreThoseOfCeres) {
  NoisyRoom room = DisturbedRoom();
  ExpectSameAsCeres(room.graph, EveryTerm(), true, &room.state);
}

TEST(EnergyTest, WithoutShapeTermsToo) {
  NoisyRoom room = DisturbedRoom();
  FactorOptions factors = EveryTerm();
  factors.shape = false;
  ExpectSameAsCeres(room.graph, factors, false, &room.state);
}

TEST(EnergyTest, FixedPosesAreHeldAlike) {
  NoisyRoom room = MakeNoisyRoom();
  room.graph.FixPose(2);
  room.graph.FixPose(7);
  DisturbPoses(0.02, room.graph, &room.state);
  ExpectSameAsCeres(room.graph, EveryTerm(), true, &room.state);
}

TEST(EnergyTest, TwoScansOnOnePoseAddUp) {
  NoisyRoom room = MakeNoisyRoom();
  const std::vector<double> ranges(180, 1.0);
  room.graph.AddScan(3, 0, ranges);
  room.graph.ExtendState(&room.state);
  DisturbPoints(0.01, &room.state);
  ExpectSameAsCeres(room.graph, EveryTerm(), true, &room.state);
}

TEST(EnergyTest, CostsAndGradientsOfARealLogAreThoseOfCeres) {
  const char* const datasets = std::getenv("PLUMBLINE_DATASETS");
  if (datasets == nullptr) GTEST_SKIP() << "PLUMBLINE_DATASETS is not set";
  CarmenLog log;
  Status status = ReadCarmenLog(std::string(datasets) + "/fr079.clf.gz", CarmenReadOptions(), &log);
  ASSERT_TRUE(status.ok()) << status.message();
  SlamGraph graph;
  status = BuildGraph(log, 300, &graph);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_EQ(graph.num_scans(), 300);
  MapState state = graph.InitialState();
  DisturbPoints(0.01, &state);
  ExpectSameAsCeres(graph, EveryTerm(), false, &state);
}

/// x^T H x / 2 + g^T x, without a preconditioner.
class Quadratic final : public CgObjective {
 public:
  Quadratic(SparseMatrix hessian, Eigen::VectorXd gradient)
      : hessian_(std::move(hessian)), gradient_(std::move(gradient)) {}

  bool Evaluate(const Vector& x, double* cost, Vector* gradient) override {
    const Eigen::VectorXd g = hessian_ * AsEigen(x) + gradient_;
    *cost = 0.5 * AsEigen(x).dot(g + gradient_);
    gradient->assign(g.data(), g.data() + g.size());
    return true;
  }
  bool Start(const Vector& x, double* cost, Vector* gradient) override {
    return Evaluate(x, cost, gradient);
  }
  double Curvature(const Vector&, const Vector& d) override {
    return AsEigen(d).dot(hessian_ * AsEigen(d));
  }
  void Precondition(const Vector&, const Vector& gradient, Vector* result) override {
    *result = gradient;
  }

  /// How far x is from the minimum, as a share of what x = 0 is.
  double Error(const Vector& x) const {
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(hessian_);
    const Eigen::VectorXd minimum = solver.solve(-gradient_);
    return (AsEigen(x) - minimum).norm() / minimum.norm();
  }

 private:
  SparseMatrix hessian_;
  Eigen::VectorXd gradient_;
};

/// Minimises by the formula of Fletcher and Reeves.
void MinimizeQuadratic(int max_steps, Quadratic* quadratic, Vector* x) {
  NonlinearCgOptions options;
  options.formula = CgFormula::kFletcherReeves;
  options.max_iterations = max_steps;
  options.relative_cost_tolerance = 0.0;
  ThreadPool pool(1);
  MinimizeByCg(options, quadratic, nullptr, &pool, x);
}

// The turns of the published method: poses while the map rests, and the map while they rest, with
// the association and the linearisation held.
TEST(EnergyTest, ConjugateGradientsSolveTheTurnsOfARealLogInAtMostAsManyStepsAsVariables) {
  const char* const datasets = std::getenv("PLUMBLINE_DATASETS");
  if (datasets == nullptr) GTEST_SKIP() << "PLUMBLINE_DATASETS is not set";
  CarmenLog log;
  ASSERT_TRUE(
      ReadCarmenLog(std::string(datasets) + "/fr079.clf.gz", CarmenReadOptions(), &log).ok());
  SlamGraph graph;
  constexpr int kNumPoses = 20;
  ASSERT_TRUE(BuildGraph(log, kNumPoses, &graph).ok());
  MapState state = graph.InitialState();
  DisturbPoints(0.01, &state);
  const Associations associations = AssociationsOf(graph, state);
  const SparseMatrix hessian = GaussNewtonHessian(graph, associations, EveryTerm(), &state);
  Oracle oracle(graph, associations, EveryTerm(), &state);
  oracle.SetAllVariable();
  double cost = 0.0;
  Vector gradient;
  ASSERT_TRUE(oracle.joint.problem->Evaluate(oracle.all, &cost, nullptr, &gradient, nullptr));
  const int num_pose_entries = 3 * kNumPoses;
  const int num_point_entries = static_cast<int>(hessian.rows()) - num_pose_entries;

  Quadratic poses(hessian.topLeftCorner(num_pose_entries, num_pose_entries),
                  AsEigen(gradient).head(num_pose_entries));
  Vector x(num_pose_entries, 0.0);
  MinimizeQuadratic(num_pose_entries, &poses, &x);
  EXPECT_LE(poses.Error(x), 1e-6);

  Quadratic points(hessian.bottomRightCorner(num_point_entries, num_point_entries),
                   AsEigen(gradient).tail(num_point_entries));
  x.assign(num_point_entries, 0.0);
  // Far fewer than there are variables: the points of one surface have nearly the same eigenvalues.
  ASSERT_GT(num_point_entries, 10000);
  MinimizeQuadratic(200, &points, &x);
  EXPECT_LE(points.Error(x), 1e-6);
}

TEST(EnergyTest, CurvatureIsThatOfTheGaussNewtonHessian) {
  NoisyRoom room = DisturbedRoom();
  const Associations associations = AssociationsOf(room.graph, room.state);
  const FactorOptions factors = EveryTerm();
  const SparseMatrix hessian = GaussNewtonHessian(room.graph, associations, factors, &room.state);
  ThreadPool pool(2);
  const Energy energy(room.graph, associations, factors, &pool);
  const Vector &poses = room.state.poses, &points = room.state.points;
  for (unsigned seed = 0; seed < 5; ++seed) {
    const Vector pose_direction = RandomVector(poses.size(), seed);
    const Vector point_direction = RandomVector(points.size(), 100 + seed);
    const auto expect = [&](bool move_poses, bool move_points) {
      Eigen::VectorXd d = Eigen::VectorXd::Zero(hessian.rows());
      if (move_poses) d.head(poses.size()) = AsEigen(pose_direction);
      if (move_points) d.tail(points.size()) = AsEigen(point_direction);
      const double expected = d.dot(hessian * d);
      EXPECT_NEAR(energy.Curvature(poses, points, move_poses ? &pose_direction : nullptr,
                                   move_points ? &point_direction : nullptr),
                  expected, 1e-9 * expected);
    };
    expect(true, false);
    expect(false, true);
    expect(true, true);
  }
  EXPECT_EQ(energy.Curvature(poses, points, nullptr, nullptr), 0.0);
}

TEST(EnergyTest, BlocksAreTheDiagonalOfTheGaussNewtonHessian) {
  NoisyRoom room = DisturbedRoom();
  const Associations associations = AssociationsOf(room.graph, room.state);
  const FactorOptions factors = EveryTerm();
  const SparseMatrix hessian = GaussNewtonHessian(room.graph, associations, factors, &room.state);
  ThreadPool pool(2);
  const Energy energy(room.graph, associations, factors, &pool);
  TermCosts costs;
  Vector pose_blocks, point_blocks;
  EnergyDerivatives derivatives;
  derivatives.pose_blocks = &pose_blocks;
  derivatives.point_blocks = &point_blocks;
  ASSERT_TRUE(energy.Evaluate(room.state.poses, room.state.points, &costs, derivatives));
  const int num_poses = room.graph.num_poses();
  const int num_points = static_cast<int>(room.graph.num_returns());
  ExpectClose(pose_blocks, DiagonalBlocks(hessian, 3, 0, num_poses), "poses");
  ExpectClose(point_blocks, DiagonalBlocks(hessian, 2, 3 * num_poses, num_points), "points");
}

TEST(EnergyTest, ChosenTermsAndTheOthersMakeTheWhole) {
  NoisyRoom room = DisturbedRoom();
  const Associations associations = AssociationsOf(room.graph, room.state);
  const FactorOptions factors = EveryTerm();
  ThreadPool pool(2);
  const Energy energy(room.graph, associations, factors, &pool);
  const Vector &poses = room.state.poses, &points = room.state.points;
  const auto evaluate = [&](const TermChoice& terms, Vector* pose_gradient,
                            Vector* point_gradient) {
    TermCosts costs;
    EnergyDerivatives derivatives;
    derivatives.pose_gradient = pose_gradient;
    derivatives.point_gradient = point_gradient;
    EXPECT_TRUE(energy.Evaluate(poses, points, &costs, derivatives, terms));
    return costs;
  };
  const Vector d_poses = RandomVector(poses.size(), 1), d_points = RandomVector(points.size(), 2);
  const auto curvature = [&](const TermChoice& terms) {
    return energy.Curvature(poses, points, &d_poses, &d_points, terms);
  };
  Vector all_poses, all_points;
  const TermCosts all = evaluate(nullptr, &all_poses, &all_points);
  for (std::size_t t = 0; t < energy.terms().size(); ++t) {
    const Term& chosen = *energy.terms()[t];
    SCOPED_TRACE(chosen.name());
    const TermChoice one = [&](const Term& term) { return &term == &chosen; };
    const TermChoice others = [&](const Term& term) { return &term != &chosen; };
    Vector poses_one, points_one, poses_others, points_others;
    const TermCosts cost_one = evaluate(one, &poses_one, &points_one);
    const TermCosts cost_others = evaluate(others, &poses_others, &points_others);
    for (std::size_t u = 0; u < energy.terms().size(); ++u) {
      EXPECT_EQ(cost_one.cost[u], u == t ? all.cost[u] : 0.0);
      EXPECT_EQ(cost_others.cost[u], u == t ? 0.0 : all.cost[u]);
    }
    const auto add = [](Vector a, const Vector& b) {
      for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
      return a;
    };
    ExpectClose(add(poses_one, poses_others), AsEigen(all_poses), "poses");
    ExpectClose(add(points_one, points_others), AsEigen(all_points), "points");
    EXPECT_NEAR(curvature(one) + curvature(others), curvature(nullptr), 1e-9 * curvature(nullptr));
  }
}

TEST(EnergyTest, AnyNumberOfThreadsGivesTheSameBits) {
  // 60 scans make more chunks of work than there are threads.
  NoisyRoomOptions options;
  options.num_poses = 60;
  options.num_beams = 60;
  NoisyRoom room = MakeNoisyRoom(options);
  DisturbPoses(0.02, room.graph, &room.state);
  const Associations associations = AssociationsOf(room.graph, room.state);
  const FactorOptions factors = EveryTerm();
  const Vector &poses = room.state.poses, &points = room.state.points;
  const Vector d_poses = RandomVector(poses.size(), 1), d_points = RandomVector(points.size(), 2);
  struct Outcome {
    TermCosts costs;
    Vector pose_gradient, point_gradient, pose_blocks, point_blocks;
    double curvature = 0.0;
  };
  const auto evaluate = [&](int num_threads) {
    ThreadPool pool(num_threads);
    const Energy energy(room.graph, associations, factors, &pool);
    Outcome out;
    EXPECT_TRUE(energy.Evaluate(
        poses, points, &out.costs,
        {&out.pose_gradient, &out.point_gradient, &out.pose_blocks, &out.point_blocks}));
    out.curvature = energy.Curvature(poses, points, &d_poses, &d_points);
    return out;
  };
  const Outcome one = evaluate(1);
  EXPECT_GT(one.costs.Total(), 0.0);
  for (const int num_threads : {2, 3, 8}) {
    const Outcome many = evaluate(num_threads);
    EXPECT_EQ(many.costs.cost, one.costs.cost);
    EXPECT_EQ(many.pose_gradient, one.pose_gradient);
    EXPECT_EQ(many.point_gradient, one.point_gradient);
    EXPECT_EQ(many.pose_blocks, one.pose_blocks);
    EXPECT_EQ(many.point_blocks, one.point_blocks);
    EXPECT_EQ(many.curvature, one.curvature);
  }
}

TEST(EnergyTest, IsUndefinedWhereAPointLiesOnItsLaser) {
  NoisyRoom room = DisturbedRoom();
  const Associations associations = AssociationsOf(room.graph, room.state);
  const FactorOptions factors = EveryTerm();
  ThreadPool pool(2);
  const Energy energy(room.graph, associations, factors, &pool);
  TermCosts costs;
  EXPECT_TRUE(energy.Evaluate(room.state.poses, room.state.points, &costs));
  Vector points = room.state.points;
  const Pose2 laser = room.graph.WorldFromLaser(0, room.state.poses);
  points[0] = laser.x;
  points[1] = laser.y;
  EXPECT_FALSE(energy.Evaluate(room.state.poses, points, &costs));
  points[0] = kNaN;
  EXPECT_FALSE(energy.Evaluate(room.state.poses, points, &costs));
  Vector poses = room.state.poses;
  poses[7] = kInfinity;
  EXPECT_FALSE(energy.Evaluate(poses, room.state.points, &costs));
}

}  // namespace
}  // namespace plumbline
