#include "plumbline/solvers/full/problem_builder.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/factors/analytic_factor.h"
#include "plumbline/factors/line_observation_factor.h"
#include "plumbline/solvers/terms/term_parts.h"
#include "plumbline/solvers/terms/terms.h"

namespace plumbline {
namespace {

constexpr int kEliminated = 0;
constexpr int kKept = 1;

ceres::Problem::Options ProblemOptions() {
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  // The checks compare each new block with all pointers in use; ours come from disjoint arrays.
  options.disable_all_safety_checks = true;
  return options;
}

// Holds a pose, if a term of the problem sees it.
void Hold(double* pose, ceres::Problem* problem) {
  if (problem->HasParameterBlock(pose)) problem->SetParameterBlockConstant(pose);
}

// Adds blocks that lie one behind the other, those that a term of the problem sees.
void Order(const ceres::Problem& problem, std::vector<double>* blocks, std::size_t block_size,
           int group, ceres::ParameterBlockOrdering* ordering) {
  for (std::size_t i = 0; i < blocks->size(); i += block_size) {
    double* block = blocks->data() + i;
    if (problem.HasParameterBlock(block)) ordering->AddElementToGroup(block, group);
  }
}

// Adds the residual blocks of terms; those of scans scan by scan.
class TermAdder {
 public:
  TermAdder(const TermList& terms, double* poses, double* points, ceres::Problem* problem,
            std::vector<std::unique_ptr<ceres::LossFunction>>* losses)
      : terms_(terms), residual_blocks_(terms.size()) {
    for (std::size_t t = 0; t < terms.size(); ++t) {
      losses->push_back(terms[t]->MakeLoss());
      targets_.push_back({problem, losses->back().get(), poses, points, &residual_blocks_[t]});
    }
  }

  void AddScans(int num_scans) {
    for (int scan = 0; scan < num_scans; ++scan) Add(true, scan);
  }
  void AddOthers() { Add(false, Term::kNoScan); }

  std::vector<std::vector<ceres::ResidualBlockId>> Take() { return std::move(residual_blocks_); }

 private:
  void Add(bool by_scan, int scan) {
    for (std::size_t t = 0; t < terms_.size(); ++t) {
      if (terms_[t]->GoesByScan() == by_scan) terms_[t]->AddTo(scan, &targets_[t]);
    }
  }

  const TermList& terms_;
  std::vector<std::vector<ceres::ResidualBlockId>> residual_blocks_;
  std::vector<TermProblem> targets_;
};

// The points to keep: of those that a residual joins, all but one.
std::vector<bool> PointsToKeep(const TermList& terms, const JointProblem& joint, MapState* state) {
  std::vector<bool> keep(state->points.size() / 2, false);
  std::vector<double*> blocks;
  for (std::size_t t = 0; t < terms.size(); ++t) {
    if (!terms[t]->JoinsPoints()) continue;
    for (const ceres::ResidualBlockId residual : joint.residual_blocks[t]) {
      joint.problem->GetParameterBlocksForResidualBlock(residual, &blocks);
      std::vector<std::size_t> eliminated;
      for (const double* block : blocks) {
        if (joint.problem->ParameterBlockSize(block) != 2) continue;
        const std::size_t point = (block - state->points.data()) / 2;
        if (!keep[point]) eliminated.push_back(point);
      }
      for (std::size_t i = 0; i + 1 < eliminated.size(); ++i) keep[eliminated[i]] = true;
    }
  }
  return keep;
}

}  // namespace

JointProblem BuildJointProblem(const SlamGraph& graph, const Associations& associations,
                               const FactorOptions& options, MapState* state,
                               const std::vector<FixedPose>* constants) {
  JointProblem joint;
  joint.problem = std::make_unique<ceres::Problem>(ProblemOptions());
  const TermList terms = MakeTerms(graph, associations, options);
  TermAdder adder(terms, state->poses.data(), state->points.data(), joint.problem.get(),
                  &joint.losses);
  adder.AddOthers();
  adder.AddScans(graph.num_scans());
  joint.residual_blocks = adder.Take();
  for (const FixedPose& fixed : constants != nullptr ? *constants : graph.fixed_poses()) {
    Hold(&state->poses[3 * fixed.pose], joint.problem.get());
  }
  const std::vector<bool> keep = PointsToKeep(terms, joint, state);
  joint.ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t r = 0; r < keep.size(); ++r) {
    joint.ordering->AddElementToGroup(&state->points[2 * r], keep[r] ? kKept : kEliminated);
  }
  Order(*joint.problem, &state->poses, 3, kKept, joint.ordering.get());
  return joint;
}

LandmarkProblem BuildLandmarkProblem(const LineObservations& observations,
                                     const std::vector<LineLandmark>& landmarks,
                                     const PoseTerms& terms, std::vector<double>* poses) {
  LandmarkProblem result;
  for (const LineLandmark& landmark : landmarks) {
    result.lines.push_back(std::atan2(landmark.normal.y(), landmark.normal.x()));
    result.lines.push_back(landmark.offset_m);
  }
  result.problem = std::make_unique<ceres::Problem>(ProblemOptions());
  TermAdder(terms.terms, poses->data(), nullptr, result.problem.get(), &result.losses).AddOthers();
  for (const LineObservation& observation : observations.observations) {
    if (observation.weight <= 0.0) continue;
    Eigen::Matrix2d scatter;
    scatter << observation.xx, observation.xy, observation.xy, observation.yy;
    const LineObservationResidual residual{std::sqrt(double{observation.weight}),
                                           observation.centroid(), SqrtScatter(scatter),
                                           landmarks[observation.landmark].origin};
    result.problem->AddResidualBlock(new LineObservationFactor(residual), nullptr,
                                     poses->data() + 3 * observation.pose,
                                     result.lines.data() + 2 * observation.landmark);
  }
  for (std::size_t pose = 0; pose < terms.is_constant.size(); ++pose) {
    if (terms.is_constant[pose]) Hold(&(*poses)[3 * pose], result.problem.get());
  }
  result.lines_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  Order(*result.problem, &result.lines, 2, kEliminated, result.lines_ordering.get());
  result.ordering = std::make_shared<ceres::ParameterBlockOrdering>(*result.lines_ordering);
  Order(*result.problem, poses, 3, kKept, result.ordering.get());
  return result;
}

}  // namespace plumbline
