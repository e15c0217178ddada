#include "plumbline/solvers/terms/terms.h"

#include <cstddef>
#include <utility>

#include "plumbline/factors/manifold_factor.h"
#include "plumbline/factors/range_beam_factor.h"
#include "plumbline/factors/relative_pose_factor.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/shape_factor.h"
#include "plumbline/solvers/terms/custom_factor_terms.h"
#include "plumbline/solvers/terms/term_of.h"

namespace plumbline {
namespace {

class EdgeTerm final : public TermOf<EdgeTerm, RelativePoseFactor, PoseId, PoseId> {
 public:
  EdgeTerm(const char* name, std::vector<PoseEdge> edges) : name_(name), edges_(std::move(edges)) {}

  std::string name() const override { return name_; }
  std::size_t num_blocks() const override { return edges_.size(); }
  NoLoss loss() const { return {}; }

  template <typename Visit>
  bool ForEach(int /*scan*/, const double* /*poses*/, const Visit& visit) const {
    for (std::size_t i = 0; i < edges_.size(); ++i) {
      const PoseEdge& edge = edges_[i];
      if (!visit(i, edge.residual, PoseId{edge.from}, PoseId{edge.to})) return false;
    }
    return true;
  }

 private:
  const char* name_;
  std::vector<PoseEdge> edges_;
};

// A return whose sweep shares what is to be known of the pose.
struct BeamOfSweep : RangeBeamResidual {
  BeamFrame frame;
  Eigen::Vector2d direction;  // in the frame of the laser

  bool Evaluate(const double* /*world_from_robot*/, const double* point_in_world, double* residuals,
                double* d_pose, double* d_point) const {
    return EvaluateRangeBeam(frame, point_in_world, range_m, direction, inv_sigma_range,
                             inv_sigma_bearing, residuals, d_pose, d_point);
  }
};

class RangeBeamTerm final : public TermOf<RangeBeamTerm, RangeBeamFactor, PoseId, PointId> {
 public:
  RangeBeamTerm(const SlamGraph& graph, const RangeBeamOptions& options)
      : graph_(graph), options_(options) {}

  std::string name() const override { return kRangeBeamTerm; }
  std::string unit() const override { return "m (as range)"; }
  double sigma() const override { return options_.sigma_range_m; }
  std::size_t num_blocks() const override { return graph_.num_returns(); }
  bool RidesAlong() const override { return true; }
  NoLoss loss() const { return {}; }

  template <typename Visit>
  bool ForEach(int scan_id, const double* poses, const Visit& visit) const {
    const std::vector<float>& ranges_m = graph_.returns().range_m;
    const ScanEntry& scan = graph_.scan(scan_id);
    const ScanReturns returns = graph_.ReturnsOfScan(scan_id);
    BeamOfSweep beam;
    beam.robot_from_laser = graph_.laser(scan.laser).robot_from_laser;
    beam.inv_sigma_range = 1.0 / options_.sigma_range_m;
    beam.inv_sigma_bearing = 1.0 / options_.sigma_bearing_rad;
    beam.frame = MakeBeamFrame(poses + 3 * scan.pose, beam.robot_from_laser);
    for (std::size_t i = scan.first_return; i < scan.first_return + scan.num_returns; ++i) {
      beam.range_m = ranges_m[i];
      beam.bearing_rad = returns.Bearing(i);
      beam.direction = returns.DirectionInLaser(i);
      if (!visit(i, beam, PoseId{scan.pose}, PointId{i})) return false;
    }
    return true;
  }

 private:
  const SlamGraph& graph_;
  const RangeBeamOptions options_;
};

class ManifoldTerm final : public TermOf<ManifoldTerm, ManifoldFactor, PointId> {
 public:
  ManifoldTerm(const SlamGraph& graph, const Associations& associations,
               const ManifoldOptions& options)
      : graph_(graph), associations_(associations), options_(options) {}

  std::string name() const override { return kManifoldTerm; }
  std::string unit() const override { return "m (robust)"; }
  double sigma() const override { return options_.sigma_m; }
  std::size_t num_blocks() const override { return associations_.lines.CountReturns(); }
  std::size_t num_measurements() const override { return graph_.num_returns(); }
  GemanMcClure loss() const { return GemanMcClure::FromGate(options_.robust_gate_sigmas); }

  template <typename Visit>
  bool ForEach(int scan_id, const double* /*poses*/, const Visit& visit) const {
    const ScanEntry& scan = graph_.scan(scan_id);
    const double inv_sigma = 1.0 / options_.sigma_m;
    for (std::size_t i = scan.first_return; i < scan.first_return + scan.num_returns; ++i) {
      if (!associations_.lines.HasLine(i)) continue;
      if (!visit(i, ManifoldResidual{associations_.lines[i], inv_sigma}, PointId{i})) return false;
    }
    return true;
  }

 private:
  const SlamGraph& graph_;
  const Associations& associations_;
  const ManifoldOptions options_;
};

class ShapeTerm final : public TermOf<ShapeTerm, ShapeFactor, PointId, PointId, PointId, PointId> {
 public:
  ShapeTerm(const SlamGraph& graph, const Associations& associations, const FactorOptions& options)
      : pairs_(associations.shape_pairs),
        gate_sigmas_(options.ShapeGateSigmas()),
        first_pair_(graph.num_scans() + 1, 0) {
    if (!options.shape) return;
    for (const ShapePair& pair : pairs_) ++first_pair_[graph.ScanOfReturn(pair.current) + 1];
    for (int s = 0; s < graph.num_scans(); ++s) first_pair_[s + 1] += first_pair_[s];
  }

  std::string name() const override { return "shape"; }
  std::string unit() const override { return "rad (robust)"; }
  double sigma() const override { return kShapeSigmaRad; }
  std::size_t num_blocks() const override { return first_pair_.back(); }
  GemanMcClure loss() const { return GemanMcClure::FromGate(gate_sigmas_); }

  template <typename Visit>
  bool ForEach(int scan_id, const double* /*poses*/, const Visit& visit) const {
    for (std::size_t p = first_pair_[scan_id]; p < first_pair_[scan_id + 1]; ++p) {
      const ShapePair& pair = pairs_[p];
      const ShapeResidual residual{pair.category, 1.0 / kShapeSigmaRad};
      if (!visit(p, residual, PointId{pair.previous}, PointId{pair.current},
                 PointId{pair.adjacent_previous}, PointId{pair.adjacent_current})) {
        return false;
      }
    }
    return true;
  }

 private:
  const std::vector<ShapePair>& pairs_;
  const double gate_sigmas_;
  std::vector<std::size_t> first_pair_;  // per scan, and the end; all zero without shape terms
};

}  // namespace

TermList MakeTerms(const SlamGraph& graph, const Associations& associations,
                   const FactorOptions& options) {
  PoseEdges edges(graph, options);
  TermList terms = {
      MakeMotionTerm(std::move(edges.motions)),
      MakeRelativePoseTerm(std::move(edges.relative_poses)),
      std::make_shared<RangeBeamTerm>(graph, options.beam),
      std::make_shared<ManifoldTerm>(graph, associations, options.manifold),
      std::make_shared<ShapeTerm>(graph, associations, options),
  };
  for (const auto& of_host : MakeFactorTerms(graph)) terms.push_back(of_host);
  return terms;
}

std::shared_ptr<const Term> MakeMotionTerm(std::vector<PoseEdge> motions) {
  return std::make_shared<EdgeTerm>(kMotionTerm, std::move(motions));
}

std::shared_ptr<const Term> MakeRelativePoseTerm(std::vector<PoseEdge> relative_poses) {
  return std::make_shared<EdgeTerm>(kRelativePoseTerm, std::move(relative_poses));
}

}  // namespace plumbline
