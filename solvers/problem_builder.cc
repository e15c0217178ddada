#include "plumbline/solvers/problem_builder.h"

#include <cmath>
#include <cstddef>

#include "plumbline/factors/analytic_factor.h"
#include "plumbline/factors/manifold_factor.h"
#include "plumbline/factors/patch_shape_factor.h"
#include "plumbline/factors/patch_sighting_factor.h"
#include "plumbline/factors/range_beam_factor.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/shape_factor.h"

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

// Calls add(term, cost, blocks...) for each.
template <typename Add>
void AddPoseTerms(const PoseTerms& terms, double* poses, const Add& add) {
  const auto add_edges = [&](Term term, const std::vector<PoseEdge>& edges) {
    for (const PoseEdge& edge : edges) {
      add(term, new RelativePoseFactor(edge.residual), poses + 3 * edge.from, poses + 3 * edge.to);
    }
  };
  add_edges(Term::kMotion, terms.motions);
  add_edges(Term::kRelativePose, terms.relative_poses);
}

// Holds the fixed poses, those that a term of the problem sees.
void HoldConstants(const PoseTerms& terms, double* poses, ceres::Problem* problem) {
  for (std::size_t pose = 0; pose < terms.is_constant.size(); ++pose) {
    double* block = poses + 3 * pose;
    if (terms.is_constant[pose] && problem->HasParameterBlock(block)) {
      problem->SetParameterBlockConstant(block);
    }
  }
}

// Adds blocks that lie one behind the other, those that a term of the problem sees.
void Order(const ceres::Problem& problem, std::vector<double>* blocks, std::size_t block_size,
           int group, ceres::ParameterBlockOrdering* ordering) {
  for (std::size_t i = 0; i < blocks->size(); i += block_size) {
    double* block = blocks->data() + i;
    if (problem.HasParameterBlock(block)) ordering->AddElementToGroup(block, group);
  }
}

class Builder {
 public:
  Builder(const SlamGraph& graph, const Associations& associations, const FactorOptions& options,
          MapState* state, JointProblem* joint)
      : graph_(graph),
        associations_(associations),
        options_(options),
        state_(state),
        poses_(state->poses.data()),
        points_(state->points.data()),
        joint_(joint) {}

  void AddPoseTerms(const PoseTerms& terms) {
    plumbline::AddPoseTerms(terms, poses_,
                            [this](Term term, ceres::CostFunction* cost, auto... blocks) {
                              Add(term, cost, nullptr, blocks...);
                            });
  }

  void AddPointTerms(ceres::LossFunction* manifold_loss) {
    const LaserReturns& returns = graph_.returns();
    const double inv_range = 1.0 / options_.beam.sigma_range_m;
    const double inv_bearing = 1.0 / options_.beam.sigma_bearing_rad;
    for (std::size_t r = 0; r < returns.size(); ++r) {
      const int scan = returns.scan[r];
      const RangeBeamResidual beam{graph_.LaserOfScan(scan).robot_from_laser, returns.range_m[r],
                                   returns.bearing_rad[r], inv_range, inv_bearing};
      Add(Term::kRangeBeam, new RangeBeamFactor(beam), nullptr, poses_ + 3 * graph_.scan(scan).pose,
          points_ + 2 * r);
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
    std::vector<bool> keep(graph_.num_returns(), false);
    if (options_.shape.enabled) {
      for (const ShapePair& pair : associations_.shape_pairs) {
        if (!keep[pair.current]) keep[pair.previous] = true;
      }
    }
    joint_->ordering = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t r = 0; r < keep.size(); ++r) {
      joint_->ordering->AddElementToGroup(points_ + 2 * r, keep[r] ? kKept : kEliminated);
    }
    Order(*joint_->problem, &state_->poses, 3, kKept, joint_->ordering.get());
  }

 private:
  template <typename... Blocks>
  void Add(Term term, ceres::CostFunction* cost, ceres::LossFunction* loss, Blocks... blocks) {
    joint_->residual_blocks[static_cast<int>(term)].push_back(
        joint_->problem->AddResidualBlock(cost, loss, blocks...));
  }

  const SlamGraph& graph_;
  const Associations& associations_;
  const FactorOptions& options_;
  MapState* state_;
  double* poses_;
  double* points_;
  JointProblem* joint_;
};

}  // namespace

JointProblem BuildJointProblem(const SlamGraph& graph, const Associations& associations,
                               const FactorOptions& options, MapState* state) {
  JointProblem joint;
  joint.problem = std::make_unique<ceres::Problem>(ProblemOptions());
  const auto make_loss = [&](double gate_sigmas) {
    joint.losses.push_back(std::make_unique<GemanMcClureLoss>(GemanMcClure::FromGate(gate_sigmas)));
    return joint.losses.back().get();
  };
  Builder builder(graph, associations, options, state, &joint);
  const PoseTerms terms(graph, options);
  builder.AddPoseTerms(terms);
  builder.AddPointTerms(make_loss(options.manifold.robust_gate_sigmas));
  builder.AddShapeTerms(make_loss(options.shape.robust_gate_sigmas));
  HoldConstants(terms, state->poses.data(), joint.problem.get());
  builder.OrderBlocks();
  return joint;
}

PatchProblem BuildPatchProblem(const PatchSightings& sightings,
                               const std::vector<SurfacePatch>& patches, const PoseTerms& terms,
                               std::vector<double>* poses) {
  PatchProblem result;
  for (const SurfacePatch& patch : patches) {
    result.lines.push_back(std::atan2(patch.normal.y(), patch.normal.x()));
    result.lines.push_back(patch.offset_m);
  }
  result.problem = std::make_unique<ceres::Problem>(ProblemOptions());
  AddPoseTerms(terms, poses->data(), [&](Term, ceres::CostFunction* cost, auto... blocks) {
    result.problem->AddResidualBlock(cost, nullptr, blocks...);
  });
  const auto symmetric = [](double xx, double xy, double yy) {
    return (Eigen::Matrix2d() << xx, xy, xy, yy).finished();
  };
  for (const PatchSighting& sighting : sightings.sightings) {
    if (sighting.weight <= 0.0) continue;
    const Eigen::Matrix2d scatter = symmetric(sighting.xx, sighting.xy, sighting.yy);
    const PatchSightingResidual residual{std::sqrt(sighting.weight), sighting.centroid,
                                         SqrtScatter(scatter), patches[sighting.patch].origin};
    result.problem->AddResidualBlock(new PatchSightingFactor(residual), nullptr,
                                     poses->data() + 3 * sighting.pose,
                                     result.lines.data() + 2 * sighting.patch);
  }
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const Eigen::Matrix2d terms_of_patch =
        symmetric(patches[p].shape_xx, patches[p].shape_xy, patches[p].shape_yy);
    double* line = result.lines.data() + 2 * p;
    if (terms_of_patch.isZero(0.0) || !result.problem->HasParameterBlock(line)) continue;
    result.problem->AddResidualBlock(new PatchShapeFactor({SqrtScatter(terms_of_patch)}), nullptr,
                                     line);
  }
  HoldConstants(terms, poses->data(), result.problem.get());
  result.lines_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  Order(*result.problem, &result.lines, 2, kEliminated, result.lines_ordering.get());
  result.ordering = std::make_shared<ceres::ParameterBlockOrdering>(*result.lines_ordering);
  Order(*result.problem, poses, 3, kKept, result.ordering.get());
  return result;
}

}  // namespace plumbline
