#include "plumbline/solvers/energy.h"

#include <algorithm>
#include <cmath>

#include "plumbline/factors/range_beam_factor.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/solvers/pose_sums.h"

namespace plumbline {
namespace {

constexpr std::size_t kScansPerChunk = 16;

// Adds rho' J^T r to the gradient and rho' J^T J to the upper triangle of the block of one
// parameter block of size N seen by a residual of size M.
template <int M, int N>
void Accumulate(double weight, const double* residuals, const double* jacobian, double* gradient,
                double* block) {
  for (int i = 0; i < N && gradient != nullptr; ++i) {
    double sum = 0.0;
    for (int k = 0; k < M; ++k) sum += jacobian[k * N + i] * residuals[k];
    gradient[i] += weight * sum;
  }
  for (int i = 0; i < N && block != nullptr; ++i) {
    for (int j = i; j < N; ++j) {
      double sum = 0.0;
      for (int k = 0; k < M; ++k) sum += jacobian[k * N + i] * jacobian[k * N + j];
      *block++ += weight * sum;
    }
  }
}

// Adds J d to `product` for one parameter block; a null direction is zero.
template <int M, int N>
void AddProduct(const double* jacobian, const double* direction, double* product) {
  if (direction == nullptr) return;
  for (int k = 0; k < M; ++k) {
    for (int i = 0; i < N; ++i) product[k] += jacobian[k * N + i] * direction[i];
  }
}

double* At(std::vector<double>* values, std::size_t index) {
  return values == nullptr ? nullptr : values->data() + index;
}
const double* At(const std::vector<double>* values, std::size_t index) {
  return values == nullptr ? nullptr : values->data() + index;
}

// Gathers costs and derivatives. Poses may be shared by scans of different chunks, so scans write
// to arrays of their own, which are added up in order afterwards.
struct Linearizer {
  TermCosts costs;
  EnergyDerivatives out;
  double* scan_gradient = nullptr;
  double* scan_block = nullptr;

  // Zeroes what the terms of a scan will add to: no other scan touches its points.
  void ClearPointsOf(const ScanEntry& scan) {
    const auto clear = [&scan](int size, std::vector<double>* values) {
      if (values == nullptr) return;
      std::fill_n(values->begin() + size * scan.first_return, size * scan.num_returns, 0.0);
    };
    clear(2, out.point_gradient);
    clear(3, out.point_blocks);
  }
  template <int M>
  void PoseAndPoint(Term term, double rho, double weight, const double* residuals, int /*pose*/,
                    const double* d_pose, std::size_t point, const double* d_point) {
    costs[term] += 0.5 * rho;
    Accumulate<M, 3>(weight, residuals, d_pose, scan_gradient, scan_block);
    Accumulate<M, 2>(weight, residuals, d_point, At(out.point_gradient, 2 * point),
                     At(out.point_blocks, 3 * point));
  }
  template <int M>
  void Points(Term term, double rho, double weight, const double* residuals, std::size_t a,
              const double* d_a) {
    costs[term] += 0.5 * rho;
    Accumulate<M, 2>(weight, residuals, d_a, At(out.point_gradient, 2 * a),
                     At(out.point_blocks, 3 * a));
  }
  template <int M>
  void Points(Term term, double rho, double weight, const double* residuals, std::size_t a,
              const double* d_a, std::size_t b, const double* d_b) {
    Points<M>(term, rho, weight, residuals, a, d_a);
    Accumulate<M, 2>(weight, residuals, d_b, At(out.point_gradient, 2 * b),
                     At(out.point_blocks, 3 * b));
  }
  void Pose(Term term, const double* residuals, int a, const double* d_a) {
    for (int k = 0; k < 3; ++k) costs[term] += 0.5 * residuals[k] * residuals[k];
    Accumulate<3, 3>(1.0, residuals, d_a, At(out.pose_gradient, 3 * a), At(out.pose_blocks, 6 * a));
  }
  void Poses(Term term, const double* residuals, int a, const double* d_a, int b,
             const double* d_b) {
    Pose(term, residuals, a, d_a);
    Accumulate<3, 3>(1.0, residuals, d_b, At(out.pose_gradient, 3 * b), At(out.pose_blocks, 6 * b));
  }
};

// Sums w |J d|^2.
struct CurvatureSum {
  const std::vector<double>* pose_direction = nullptr;
  const std::vector<double>* point_direction = nullptr;
  double sum = 0.0;

  template <int M>
  void Add(double weight, const double* product) {
    for (int k = 0; k < M; ++k) sum += weight * product[k] * product[k];
  }
  template <int M>
  void PoseAndPoint(Term, double, double weight, const double*, int pose, const double* d_pose,
                    std::size_t point, const double* d_point) {
    double product[M] = {};
    AddProduct<M, 3>(d_pose, At(pose_direction, 3 * pose), product);
    AddProduct<M, 2>(d_point, At(point_direction, 2 * point), product);
    Add<M>(weight, product);
  }
  template <int M>
  void Points(Term, double, double weight, const double*, std::size_t a, const double* d_a) {
    double product[M] = {};
    AddProduct<M, 2>(d_a, At(point_direction, 2 * a), product);
    Add<M>(weight, product);
  }
  template <int M>
  void Points(Term, double, double weight, const double*, std::size_t a, const double* d_a,
              std::size_t b, const double* d_b) {
    double product[M] = {};
    AddProduct<M, 2>(d_a, At(point_direction, 2 * a), product);
    AddProduct<M, 2>(d_b, At(point_direction, 2 * b), product);
    Add<M>(weight, product);
  }
  void Pose(Term, const double*, int a, const double* d_a) {
    double product[3] = {};
    AddProduct<3, 3>(d_a, At(pose_direction, 3 * a), product);
    Add<3>(1.0, product);
  }
  void Poses(Term, const double*, int a, const double* d_a, int b, const double* d_b) {
    double product[3] = {};
    AddProduct<3, 3>(d_a, At(pose_direction, 3 * a), product);
    AddProduct<3, 3>(d_b, At(pose_direction, 3 * b), product);
    Add<3>(1.0, product);
  }
};

void Resize(std::vector<double>* values, std::size_t size) {
  if (values != nullptr) values->resize(size);
}

void SetZero(std::vector<double>* values, std::size_t size) {
  if (values != nullptr) values->assign(size, 0.0);
}

}  // namespace

const char* ToString(Term term) {
  switch (term) {
    case Term::kMotion:
      return "motion";
    case Term::kRelativePose:
      return "relative pose";
    case Term::kRangeBeam:
      return "range beam";
    case Term::kManifold:
      return "manifold";
    case Term::kShape:
      return "shape";
  }
  return "";
}

double TermCosts::Total() const {
  double total = 0.0;
  for (const double c : cost) total += c;
  return total;
}

TermCosts& TermCosts::operator+=(const TermCosts& other) {
  for (int i = 0; i < kNumTerms; ++i) cost[i] += other.cost[i];
  return *this;
}

Energy::Energy(const SlamGraph& graph, const Associations& associations,
               const FactorOptions& options, ThreadPool* pool)
    : graph_(graph),
      associations_(associations),
      options_(options),
      pool_(pool),
      pose_terms_(graph, options) {
  first_shape_pair_.assign(graph.num_scans() + 1, 0);
  for (const ShapePair& pair : associations.shape_pairs) {
    ++first_shape_pair_[graph.returns().scan[pair.current] + 1];
  }
  for (int s = 0; s < graph.num_scans(); ++s) first_shape_pair_[s + 1] += first_shape_pair_[s];
}

template <typename Visitor>
bool Energy::VisitBeams(const ScanEntry& scan, const std::vector<double>& poses,
                        const std::vector<double>& points, bool with_jacobians,
                        Visitor* visitor) const {
  const LaserReturns& returns = graph_.returns();
  const BeamFrame frame =
      MakeBeamFrame(&poses[3 * scan.pose], graph_.laser(scan.laser).robot_from_laser);
  const double inv_range = 1.0 / options_.beam.sigma_range_m;
  const double inv_bearing = 1.0 / options_.beam.sigma_bearing_rad;
  double r[2] = {}, d_pose[6] = {}, d_point[4] = {};
  for (std::size_t i = scan.first_return; i < scan.first_return + scan.num_returns; ++i) {
    if (!EvaluateRangeBeam(frame, &points[2 * i], returns.range_m[i], returns.bearing_rad[i],
                           inv_range, inv_bearing, r, with_jacobians ? d_pose : nullptr,
                           with_jacobians ? d_point : nullptr)) {
      return false;
    }
    visitor->template PoseAndPoint<2>(Term::kRangeBeam, r[0] * r[0] + r[1] * r[1], 1.0, r,
                                      scan.pose, d_pose, i, d_point);
  }
  return true;
}

template <typename Visitor>
bool Energy::VisitLines(const ScanEntry& scan, const std::vector<double>& points,
                        bool with_jacobians, Visitor* visitor) const {
  const double inv_sigma = 1.0 / options_.manifold.sigma_m;
  const GemanMcClure loss = GemanMcClure::FromGate(options_.manifold.robust_gate_sigmas);
  double r = 0.0, d_point[2] = {};
  for (std::size_t i = scan.first_return; i < scan.first_return + scan.num_returns; ++i) {
    const TangentLine& line = associations_.lines[i];
    if (!Associations::HasLine(line)) continue;
    if (!EvaluateManifold(line, &points[2 * i], inv_sigma, &r,
                          with_jacobians ? d_point : nullptr)) {
      return false;
    }
    const double s = r * r;
    visitor->template Points<1>(Term::kManifold, loss.Rho(s), loss.Weight(s), &r, i, d_point);
  }
  return true;
}

template <typename Visitor>
bool Energy::VisitShapePairs(int scan_id, const std::vector<double>& points, bool with_jacobians,
                             Visitor* visitor) const {
  if (!options_.shape.enabled) return true;
  const double inv_sigma = 1.0 / options_.shape.sigma_rad;
  const GemanMcClure loss = GemanMcClure::FromGate(options_.shape.robust_gate_sigmas);
  double r[2] = {}, d_previous[4] = {}, d_current[4] = {};
  for (std::size_t p = first_shape_pair_[scan_id]; p < first_shape_pair_[scan_id + 1]; ++p) {
    const ShapePair& pair = associations_.shape_pairs[p];
    if (!EvaluateShape(&points[2 * pair.previous], &points[2 * pair.current],
                       TurnBack(pair.category, pair.adjacent_normal), inv_sigma, r,
                       with_jacobians ? d_previous : nullptr,
                       with_jacobians ? d_current : nullptr)) {
      return false;
    }
    const double s = r[0] * r[0] + r[1] * r[1];
    visitor->template Points<2>(Term::kShape, loss.Rho(s), loss.Weight(s), r, pair.previous,
                                d_previous, pair.current, d_current);
  }
  return true;
}

template <typename Visitor>
bool Energy::VisitScan(int scan_id, const std::vector<double>& poses,
                       const std::vector<double>& points, TermSet terms, bool with_jacobians,
                       Visitor* visitor) const {
  const ScanEntry& scan = graph_.scan(scan_id);
  return (!terms.Has(Term::kRangeBeam) ||
          VisitBeams(scan, poses, points, with_jacobians, visitor)) &&
         (!terms.Has(Term::kManifold) || VisitLines(scan, points, with_jacobians, visitor)) &&
         (!terms.Has(Term::kShape) || VisitShapePairs(scan_id, points, with_jacobians, visitor));
}

template <typename Visitor>
bool Energy::VisitPoseTerms(const std::vector<double>& poses, TermSet terms,
                            Visitor* visitor) const {
  double r[3], d_a[9], d_b[9];
  const auto visit_edges = [&](Term term, const std::vector<PoseEdge>& edges) {
    if (!terms.Has(term)) return true;
    for (const PoseEdge& edge : edges) {
      if (!edge.residual.Evaluate(&poses[3 * edge.from], &poses[3 * edge.to], r, d_a, d_b)) {
        return false;
      }
      visitor->Poses(term, r, edge.from, d_a, edge.to, d_b);
    }
    return true;
  };
  return visit_edges(Term::kMotion, pose_terms_.motions) &&
         visit_edges(Term::kRelativePose, pose_terms_.relative_poses);
}

bool Energy::Evaluate(const std::vector<double>& poses, const std::vector<double>& points,
                      TermCosts* costs, const EnergyDerivatives& derivatives, TermSet terms) const {
  SetZero(derivatives.pose_gradient, poses.size());
  SetZero(derivatives.pose_blocks, 2 * poses.size());
  Resize(derivatives.point_gradient, points.size());
  Resize(derivatives.point_blocks, points.size() / 2 * 3);
  const bool with_jacobians =
      derivatives.pose_gradient != nullptr || derivatives.pose_blocks != nullptr ||
      derivatives.point_gradient != nullptr || derivatives.point_blocks != nullptr;
  std::vector<double> scan_gradients(derivatives.pose_gradient ? 3 * graph_.num_scans() : 0);
  std::vector<double> scan_blocks(derivatives.pose_blocks ? 6 * graph_.num_scans() : 0);

  const std::size_t num_chunks = ThreadPool::NumChunks(graph_.num_scans(), kScansPerChunk);
  std::vector<TermCosts> chunk_costs(num_chunks);
  std::vector<char> chunk_ok(num_chunks, false);
  pool_->ForEachChunk(graph_.num_scans(), kScansPerChunk,
                      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                        Linearizer linearizer;
                        linearizer.out = derivatives;
                        bool ok = true;
                        for (std::size_t s = begin; s < end && ok; ++s) {
                          if (!scan_gradients.empty())
                            linearizer.scan_gradient = &scan_gradients[3 * s];
                          if (!scan_blocks.empty()) linearizer.scan_block = &scan_blocks[6 * s];
                          const int scan = static_cast<int>(s);
                          linearizer.ClearPointsOf(graph_.scan(scan));
                          ok = VisitScan(scan, poses, points, terms, with_jacobians, &linearizer);
                        }
                        chunk_costs[chunk] = linearizer.costs;
                        chunk_ok[chunk] = ok;
                      });

  Linearizer linearizer;
  linearizer.out = derivatives;
  bool ok = VisitPoseTerms(poses, terms, &linearizer);
  *costs = linearizer.costs;
  for (std::size_t chunk = 0; chunk < num_chunks; ++chunk) {
    *costs += chunk_costs[chunk];
    ok = ok && chunk_ok[chunk];
  }
  if (derivatives.pose_gradient) {
    AddToPoses<3>(graph_, scan_gradients, derivatives.pose_gradient);
    HoldConstants(derivatives.pose_gradient);
  }
  if (derivatives.pose_blocks) AddToPoses<6>(graph_, scan_blocks, derivatives.pose_blocks);
  return ok && std::isfinite(costs->Total());
}

void Energy::HoldConstants(std::vector<double>* gradient) const {
  for (const FixedPose& fixed : graph_.fixed_poses()) {
    std::fill_n(gradient->begin() + 3 * fixed.pose, 3, 0.0);
  }
}

double Energy::Curvature(const std::vector<double>& poses, const std::vector<double>& points,
                         const std::vector<double>* pose_direction,
                         const std::vector<double>* point_direction, TermSet terms) const {
  const std::size_t num_chunks = ThreadPool::NumChunks(graph_.num_scans(), kScansPerChunk);
  std::vector<double> sums(num_chunks, 0.0);
  pool_->ForEachChunk(graph_.num_scans(), kScansPerChunk,
                      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                        CurvatureSum curvature{pose_direction, point_direction};
                        for (std::size_t s = begin; s < end; ++s) {
                          VisitScan(static_cast<int>(s), poses, points, terms, true, &curvature);
                        }
                        sums[chunk] = curvature.sum;
                      });
  CurvatureSum curvature{pose_direction, point_direction};
  if (pose_direction != nullptr) VisitPoseTerms(poses, terms, &curvature);
  double total = curvature.sum;
  for (const double sum : sums) total += sum;
  return total;
}

std::array<std::size_t, kNumTerms> Energy::CountTerms() const {
  std::array<std::size_t, kNumTerms> counts{};
  counts[static_cast<int>(Term::kMotion)] = pose_terms_.motions.size();
  counts[static_cast<int>(Term::kRelativePose)] = pose_terms_.relative_poses.size();
  counts[static_cast<int>(Term::kRangeBeam)] = graph_.num_returns();
  counts[static_cast<int>(Term::kManifold)] = associations_.CountLines();
  counts[static_cast<int>(Term::kShape)] =
      options_.shape.enabled ? associations_.shape_pairs.size() : 0;
  return counts;
}

}  // namespace plumbline
