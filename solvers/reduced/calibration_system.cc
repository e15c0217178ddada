#include "plumbline/solvers/reduced/calibration_system.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <cstddef>
#include <string>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/reduced/pose_preconditioner.h"
#include "plumbline/solvers/terms/custom_factor_terms.h"

namespace plumbline {
namespace {

// Of the right-hand side, in the preconditioner's norm: what the data say of a parameter is a
// difference of two numbers that may share the first digits.
constexpr double kTolerance = 1e-4;
constexpr int kMaxIterations = 2000;

using RowMajor3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

// The residual of an edge at the graph's poses, with its derivatives.
struct LinearEdge {
  Eigen::Vector3d residual;
  RowMajor3d by_from, by_to;
  CalibrationRows by_theta;

  LinearEdge(const CalibratedGraph& graph, const PoseEdge& edge, bool is_odometry) {
    const double* from = &graph.poses()[3 * edge.from];
    const double* to = &graph.poses()[3 * edge.to];
    edge.residual.Evaluate(from, to, residual.data(), by_from.data(), by_to.data());
    by_theta = by_from * graph.CarriedBy(edge.from) + by_to * graph.CarriedBy(edge.to);
    if (!is_odometry) return;
    // U (t / scale - what the odometry read), t the motion by the poses.
    by_theta.col(kLogOdometryScale) -= edge.residual.sqrt_information.leftCols<2>() *
                                       Between(Pose2(from), Pose2(to)).translation();
  }
};

// Takes the equations of terms that see poses only, for poses that are carried along.
class CarriedEquations final : public PoseEquations {
 public:
  CarriedEquations(const CalibratedGraph& graph, const PoseSystem& poses, CalibrationSystem* system)
      : graph_(graph), poses_(poses), system_(*system) {}

  void Add(int pose, const Eigen::Matrix3d& block, const Eigen::Vector3d& gradient) override {
    const CalibrationRows carried = graph_.CarriedBy(pose);
    AddToBorder(pose, block * carried);
    system_.information += carried.transpose() * block * carried;
    system_.gradient += carried.transpose() * gradient;
  }

  void AddCoupling(int a, int b, const Eigen::Matrix3d& block) override {
    const CalibrationRows carried_a = graph_.CarriedBy(a), carried_b = graph_.CarriedBy(b);
    AddToBorder(a, block.transpose() * carried_b);
    AddToBorder(b, block * carried_a);
    const CalibrationMatrix both = carried_b.transpose() * block * carried_a;
    system_.information += both + both.transpose();
  }

 private:
  void AddToBorder(int pose, const CalibrationRows& rows) {
    const int row = poses_.row_of_pose[pose];
    if (row != PoseSystem::kConstant) system_.border.middleRows<3>(3 * row) += rows;
  }

  const CalibratedGraph& graph_;
  const PoseSystem& poses_;
  CalibrationSystem& system_;
};

// S^-1 times the columns.
Status SolveColumns(const PoseSystem& poses, const LineObservations& observations,
                    const std::vector<PoseFrame>& frames, const Eigen::MatrixXd& columns,
                    const PoseSystemSolver* linear_solver, ThreadPool* pool,
                    Eigen::MatrixXd* solved) {
  const PosePreconditioner preconditioner(poses, observations, frames, pool);
  solved->resize(columns.rows(), columns.cols());
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    Eigen::VectorXd x;
    const PoseSystemResult result =
        SolvePoseSystemBy(linear_solver, poses, observations, preconditioner, columns.col(i),
                          kTolerance, kMaxIterations, pool, &x);
    if (!result.converged) {
      return Status::Unavailable("the calibration's linear system did not converge in " +
                                 std::to_string(result.iterations) + " iterations");
    }
    solved->col(i) = x;
  }
  return Status::Ok();
}

}  // namespace

CalibrationSystem::CalibrationSystem(const CalibratedGraph& graph, const PoseEdges& edges,
                                     const LineObservations& observations,
                                     const std::vector<RangeSlope>& slopes,
                                     const std::vector<LineLandmark>& landmarks,
                                     const std::vector<PoseFrame>& frames,
                                     const PoseSystem& poses) {
  border.setZero(poses.gradient.size(), kNumCalibrationParameters);
  AddPoseEdges(graph, edges, poses);
  AddFactors(graph, poses);
  AddRangeBias(std::exp(graph.theta()[kLogRangeScale]), observations, slopes, landmarks, frames,
               poses);
}

void CalibrationSystem::AddPoseEdges(const CalibratedGraph& graph, const PoseEdges& edges,
                                     const PoseSystem& poses) {
  const auto add = [&](int pose, const RowMajor3d& by_pose, const CalibrationRows& by_theta) {
    const int row = poses.row_of_pose[pose];
    if (row == PoseSystem::kConstant) return;
    border.middleRows<3>(3 * row) += by_pose.transpose() * by_theta;
  };
  for (const std::vector<PoseEdge>* kind : {&edges.motions, &edges.relative_poses}) {
    for (const PoseEdge& edge : *kind) {
      const LinearEdge linear(graph, edge, kind == &edges.motions);
      add(edge.from, linear.by_from, linear.by_theta);
      add(edge.to, linear.by_to, linear.by_theta);
      information += linear.by_theta.transpose() * linear.by_theta;
      gradient += linear.by_theta.transpose() * linear.residual;
    }
  }
}

void CalibrationSystem::AddFactors(const CalibratedGraph& graph, const PoseSystem& poses) {
  CarriedEquations equations(graph, poses, this);
  for (const auto& term : MakeFactorTerms(graph.graph())) {
    if (!term->SeesPoints()) term->AddEquations(graph.poses().data(), &equations);
  }
}

void CalibrationSystem::AddRangeBias(double range_scale, const LineObservations& observations,
                                     const std::vector<RangeSlope>& slopes,
                                     const std::vector<LineLandmark>& landmarks,
                                     const std::vector<PoseFrame>& frames,
                                     const PoseSystem& poses) {
  // How the range bias couples to the line of a landmark, by what the poses here saw of it.
  const auto by_line_of = [&](std::size_t p) {
    const LineLandmark& landmark = landmarks[p];
    const Eigen::Vector2d tangent = TurnedLeft(landmark.normal);
    Eigen::Vector2d by_line = Eigen::Vector2d::Zero();
    for (std::size_t i = observations.first_of_landmark[p];
         i < observations.first_of_landmark[p + 1]; ++i) {
      const PoseFrame& frame = frames[observations.observations[i].pose];
      const double weight = range_scale * slopes[i].weight;
      const Eigen::Vector2d moment = range_scale * frame.Rotate(slopes[i].moment);
      by_line += Eigen::Vector2d(
          tangent.dot(moment + weight * (frame.translation() - landmark.origin)), -weight);
    }
    return by_line;
  };
  const SharedLandmarks& shared = observations.shared;
  const std::vector<Eigen::Vector2d> shared_by_line = shared.Sum<2>(by_line_of);
  double bias_information = 0.0, bias_gradient = 0.0;
  for (std::size_t p = 0; p < landmarks.size(); ++p) {
    const Eigen::Vector2d& normal = landmarks[p].normal;
    const int slot = shared.SlotOf(p);
    const Eigen::Vector2d by_line =
        slot == SharedLandmarks::kNotShared ? by_line_of(p) : shared_by_line[slot];
    const Eigen::Vector2d whitened = poses.line_whitening[p].transpose() * by_line;
    if (shared.IsCountedHere(p)) bias_information -= whitened.squaredNorm();
    for (std::size_t i = observations.first_of_landmark[p];
         i < observations.first_of_landmark[p + 1]; ++i) {
      const RangeSlope& slope = slopes[i];
      bias_information += range_scale * range_scale * slope.curvature;
      bias_gradient += range_scale * slope.gradient;
      const LineCoupling& coupling = poses.line_coupling[i];
      if (coupling.row == PoseSystem::kConstant) continue;
      const PoseFrame& frame = frames[observations.observations[i].pose];
      const double weight = range_scale * slope.weight;
      const double turn = -TurnedLeft(normal).dot(range_scale * frame.Rotate(slope.moment));
      border.col(kRangeBias).segment<3>(3 * coupling.row) +=
          Eigen::Vector3d(weight * normal.x(), weight * normal.y(), turn) -
          coupling.Rows(poses.line_normal[p]) * whitened;
    }
  }
  std::vector<double> sums = {bias_information, bias_gradient};
  SumOverPeers(poses.peers, &sums);
  information(kRangeBias, kRangeBias) += sums[0];
  gradient[kRangeBias] += sums[1];
}

Status SolveCalibrationStep(const CalibrationSystem& system, const PoseSystem& poses,
                            const LineObservations& observations,
                            const std::vector<PoseFrame>& frames, const std::vector<int>& active,
                            const CalibrationVector& prior_sigmas, const CalibrationVector& theta,
                            const PoseSystemSolver* linear_solver, ThreadPool* pool,
                            CalibrationStep* step) {
  const auto size = static_cast<Eigen::Index>(active.size());
  // Of each active parameter and, last, of the poses' gradient.
  Eigen::MatrixXd border(poses.gradient.size(), size + 1), solved;
  for (Eigen::Index i = 0; i < size; ++i) border.col(i) = system.border.col(active[i]);
  border.col(size) = poses.gradient;
  PLUMBLINE_RETURN_IF_ERROR(
      SolveColumns(poses, observations, frames, border, linear_solver, pool, &solved));
  // border^T S^-1 [ border  gradient ]
  Eigen::MatrixXd eliminated = border.leftCols(size).transpose() * solved;
  if (poses.peers != nullptr) {
    poses.peers->Sum(eliminated.data(), static_cast<std::size_t>(eliminated.size()));
  }
  Eigen::MatrixXd schur = -eliminated.leftCols(size);
  Eigen::VectorXd descent = eliminated.col(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) schur(i, j) += system.information(active[i], active[j]);
    const double prior = 1.0 / (prior_sigmas[active[i]] * prior_sigmas[active[i]]);
    schur(i, i) += prior;
    descent[i] -= system.gradient[active[i]] + prior * theta[active[i]];
  }
  // Symmetric but for the last digits of the iteration.
  const Eigen::LLT<Eigen::MatrixXd> llt(0.5 * (schur + schur.transpose()));
  if (llt.info() != Eigen::Success) {
    return Status::Unavailable("the calibration's linear system is not positive definite");
  }
  const Eigen::VectorXd change = llt.solve(descent);
  const Eigen::MatrixXd covariance = llt.solve(Eigen::MatrixXd::Identity(size, size));
  *step = CalibrationStep();
  const Eigen::MatrixXd by_pose = poses.ByPose(solved);
  step->response.setZero(by_pose.rows(), kNumCalibrationParameters);
  step->poses = -by_pose.col(size) - by_pose.leftCols(size) * change;
  for (Eigen::Index i = 0; i < size; ++i) {
    step->theta[active[i]] = change[i];
    step->response.col(active[i]) = -by_pose.col(i);
    for (Eigen::Index j = 0; j < size; ++j) {
      step->covariance(active[i], active[j]) = covariance(i, j);
    }
  }
  return Status::Ok();
}

CalibrationMatrix ObservedCovariance(const CalibratedGraph& graph, const PoseEdges& edges,
                                     const CalibrationStep& step) {
  CalibrationMatrix excess = CalibrationMatrix::Zero();
  for (const PoseEdge& edge : edges.motions) {
    const LinearEdge linear(graph, edge, true);
    const CalibrationRows by_theta = linear.by_theta +
                                     linear.by_from * step.response.middleRows<3>(3 * edge.from) +
                                     linear.by_to * step.response.middleRows<3>(3 * edge.to);
    const CalibrationVector score = by_theta.transpose() * linear.residual;
    excess += score * score.transpose() - by_theta.transpose() * by_theta;
  }
  return step.covariance + step.covariance * excess * step.covariance;
}

}  // namespace plumbline
