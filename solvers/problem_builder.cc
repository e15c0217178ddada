#include "plumbline/solvers/problem_builder.h"

#include <cstddef>

#include "plumbline/factors/manifold_factor.h"
#include "plumbline/factors/pose_prior_factor.h"
#include "plumbline/factors/range_beam_factor.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/shape_factor.h"
#include "plumbline/solvers/pose_terms.h"

namespace plumbline {
namespace {

class Builder {
 public:
  Builder(const Associations& associations, const FactorOptions& options, SlamGraph* graph,
          JointProblem* joint)
      : associations_(associations),
        options_(options),
        graph_(graph),
        poses_(graph->poses().data()),
        points_(graph->points().data()),
        joint_(joint) {}

  void AddPoseTerms() {
    const PoseTerms terms(*graph_, options_);
    for (const PosePrior& prior : terms.priors) {
      Add(Term::kPosePrior, new PosePriorFactor(prior.residual), nullptr, poses_ + 3 * prior.pose);
    }
    const auto add_edges = [this](Term term, const std::vector<PoseEdge>& edges) {
      for (const PoseEdge& edge : edges) {
        Add(term, new RelativePoseFactor(edge.residual), nullptr, poses_ + 3 * edge.from,
            poses_ + 3 * edge.to);
      }
    };
    add_edges(Term::kMotion, terms.motions);
    add_edges(Term::kRelativePose, terms.relative_poses);
  }

  void AddPointTerms(ceres::LossFunction* manifold_loss) {
    const LaserReturns& returns = graph_->returns();
    const double inv_range = 1.0 / options_.beam.sigma_range_m;
    const double inv_bearing = 1.0 / options_.beam.sigma_bearing_rad;
    for (std::size_t r = 0; r < returns.size(); ++r) {
      const int scan = returns.scan[r];
      const RangeBeamResidual beam{graph_->LaserOfScan(scan).robot_from_laser, returns.range_m[r],
                                   returns.bearing_rad[r], inv_range, inv_bearing};
      Add(Term::kRangeBeam, new RangeBeamFactor(beam), nullptr,
          poses_ + 3 * graph_->scan(scan).pose, points_ + 2 * r);
      if (!Associations::HasLine(associations_.lines[r])) continue;
      const ManifoldResidual manifold{associations_.lines[r], 1.0 / options_.manifold.sigma_m};
      Add(Term::kManifold, new ManifoldFactor(manifold), manifold_loss, points_ + 2 * r);
    }
  }

  void AddShapeTerms(ceres::LossFunction* shape_loss) {
    if (!options_.shape.enabled) return;
    for (const ShapePair& pair : associations_.shape_pairs) {
      const ShapeResidual shape(pair.adjacent_normal, pair.category, options_.shape.sigma_rad);
      Add(Term::kShape, new ShapeFactor(shape), shape_loss, points_ + 2 * pair.previous,
          points_ + 2 * pair.current);
    }
  }

  void OrderBlocks() {
    std::vector<bool> keep(graph_->num_returns(), false);
    if (options_.shape.enabled) {
      for (const ShapePair& pair : associations_.shape_pairs) {
        if (!keep[pair.current]) keep[pair.previous] = true;
      }
    }
    joint_->ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t r = 0; r < keep.size(); ++r) {
      joint_->ordering->AddElementToGroup(points_ + 2 * r, keep[r] ? 1 : 0);
    }
    for (int p = 0; p < graph_->num_poses(); ++p) {
      if (joint_->problem->HasParameterBlock(poses_ + 3 * p)) {
        joint_->ordering->AddElementToGroup(poses_ + 3 * p, 1);
      }
    }
  }

 private:
  template <typename... Blocks>
  void Add(Term term, ceres::CostFunction* cost, ceres::LossFunction* loss, Blocks... blocks) {
    joint_->residual_blocks[static_cast<int>(term)].push_back(
        joint_->problem->AddResidualBlock(cost, loss, blocks...));
  }

  const Associations& associations_;
  const FactorOptions& options_;
  SlamGraph* graph_;
  double* poses_;
  double* points_;
  JointProblem* joint_;
};

}  // namespace

JointProblem BuildJointProblem(const Associations& associations, const FactorOptions& options,
                               SlamGraph* graph) {
  JointProblem joint;
  ceres::Problem::Options problem_options;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  // The checks compare each new block with all pointers in use; ours come from disjoint arrays.
  problem_options.disable_all_safety_checks = true;
  joint.problem = std::make_unique<ceres::Problem>(problem_options);
  const auto make_loss = [&](double gate_sigmas) {
    joint.losses.push_back(std::make_unique<GemanMcClureLoss>(GemanMcClure::FromGate(gate_sigmas)));
    return joint.losses.back().get();
  };
  Builder builder(associations, options, graph, &joint);
  builder.AddPoseTerms();
  builder.AddPointTerms(make_loss(options.manifold.robust_gate_sigmas));
  builder.AddShapeTerms(make_loss(options.shape.robust_gate_sigmas));
  builder.OrderBlocks();
  return joint;
}

}  // namespace plumbline
