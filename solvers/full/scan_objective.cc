#include "plumbline/solvers/full/scan_objective.h"

#include <cmath>
#include <cstddef>

#include "plumbline/solvers/full/pose_sums.h"
#include "plumbline/solvers/full/scan_chunk.h"

namespace plumbline {
namespace {

// Calls body(scan) for all scans of the graph, on all threads.
template <typename Body>
void ForEachScan(const SlamGraph& graph, ThreadPool* pool, const Body& body) {
  pool->ForEachChunk(graph.num_scans(), kScansPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       for (std::size_t s = begin; s < end; ++s) body(static_cast<int>(s));
                     });
}

// Adds the N values that body(scan, values) finds for each scan to those of the scan's pose: on all
// threads, but in the order of scans.
template <int N, typename Body>
void AddForEachScan(const SlamGraph& graph, ThreadPool* pool, const Body& body,
                    std::vector<double>* of_poses) {
  std::vector<double> of_scans(N * graph.num_scans(), 0.0);
  ForEachScan(graph, pool, [&](int s) { body(graph.scan(s), &of_scans[N * s]); });
  AddToPoses<N>(graph, of_scans, of_poses);
}

// Whether a term changes when scans move with their points.
bool Moves(const Term& term) { return !term.RidesAlong(); }

}  // namespace

void ScanObjective::AttachPoints(const MapState& state) {
  attached_.resize(state.points.size());
  ForEachScan(graph_, energy_.pool(), [&](int s) {
    const ScanEntry& scan = graph_.scan(s);
    const double* pose = &state.poses[3 * scan.pose];
    const double c = std::cos(pose[2]), sn = std::sin(pose[2]);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const double dx = state.points[2 * r] - pose[0];
      const double dy = state.points[2 * r + 1] - pose[1];
      attached_[2 * r] = c * dx + sn * dy;
      attached_[2 * r + 1] = -sn * dx + c * dy;
    }
  });
}

void ScanObjective::PlacePoints(const std::vector<double>& x, std::vector<double>* points) const {
  points->resize(attached_.size());
  ForEachScan(graph_, energy_.pool(), [&](int s) {
    const ScanEntry& scan = graph_.scan(s);
    const double* pose = &x[3 * scan.pose];
    const double c = std::cos(pose[2]), sn = std::sin(pose[2]);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      (*points)[2 * r] = pose[0] + c * attached_[2 * r] - sn * attached_[2 * r + 1];
      (*points)[2 * r + 1] = pose[1] + sn * attached_[2 * r] + c * attached_[2 * r + 1];
    }
  });
}

bool ScanObjective::Evaluate(const std::vector<double>& x, double* cost,
                             std::vector<double>* gradient) {
  PlacePoints(x, &points_);
  TermCosts costs;
  EnergyDerivatives derivatives;
  derivatives.pose_gradient = gradient;
  derivatives.point_gradient = &point_gradient_;
  const bool ok = energy_.Evaluate(x, points_, &costs, derivatives, Moves);
  *cost = fixed_cost_ + costs.Total();
  // Chain rule: a point turns about its robot, dm/dyaw = (-(m - t)_y, (m - t)_x).
  const auto add_points = [&](const ScanEntry& scan, double* g) {
    const double* pose = &x[3 * scan.pose];
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const double gx = point_gradient_[2 * r], gy = point_gradient_[2 * r + 1];
      g[0] += gx;
      g[1] += gy;
      g[2] += -(points_[2 * r + 1] - pose[1]) * gx + (points_[2 * r] - pose[0]) * gy;
    }
  };
  AddForEachScan<3>(graph_, energy_.pool(), add_points, gradient);
  energy_.HoldConstants(gradient);
  return ok;
}

bool ScanObjective::Start(const std::vector<double>& x, double* cost,
                          std::vector<double>* gradient) {
  PlacePoints(x, &points_);
  TermCosts costs;
  std::vector<double> blocks;
  EnergyDerivatives derivatives;
  derivatives.pose_blocks = &blocks;
  const auto sees_poses_only = [](const Term& term) { return !term.SeesPoints(); };
  if (!energy_.Evaluate(x, points_, &costs, derivatives, sees_poses_only)) return false;
  energy_.AddCarriedBlocks(x, points_, &blocks);
  preconditioner_.Set(blocks, energy_.pool());
  return Resume(x, cost, gradient);
}

bool ScanObjective::Resume(const std::vector<double>& x, double* cost,
                           std::vector<double>* gradient) {
  PlacePoints(x, &points_);
  TermCosts costs;
  const auto stays = [](const Term& term) { return term.RidesAlong(); };
  if (!energy_.Evaluate(x, points_, &costs, {}, stays)) return false;
  fixed_cost_ = costs.Total();
  return Evaluate(x, cost, gradient);
}

double ScanObjective::Curvature(const std::vector<double>& x,
                                const std::vector<double>& direction) {
  PlacePoints(x, &points_);
  point_direction_.resize(points_.size());
  ForEachScan(graph_, energy_.pool(), [&](int s) {
    const ScanEntry& scan = graph_.scan(s);
    const double* pose = &x[3 * scan.pose];
    const double* d = &direction[3 * scan.pose];
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      point_direction_[2 * r] = d[0] - (points_[2 * r + 1] - pose[1]) * d[2];
      point_direction_[2 * r + 1] = d[1] + (points_[2 * r] - pose[0]) * d[2];
    }
  });
  return energy_.Curvature(x, points_, &direction, &point_direction_, Moves);
}

void ScanObjective::Precondition(const std::vector<double>& /*x*/,
                                 const std::vector<double>& gradient, std::vector<double>* result) {
  preconditioner_.Apply(gradient, energy_.pool(), result);
}

}  // namespace plumbline
