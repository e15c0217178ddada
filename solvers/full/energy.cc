#include "plumbline/solvers/full/energy.h"

#include <algorithm>
#include <cmath>

#include "plumbline/core/over_peers.h"
#include "plumbline/solvers/full/pose_sums.h"
#include "plumbline/solvers/full/scan_chunk.h"
#include "plumbline/solvers/terms/terms.h"

namespace plumbline {
namespace {

double* Data(std::vector<double>* values) { return values == nullptr ? nullptr : values->data(); }
const double* Data(const std::vector<double>* values) {
  return values == nullptr ? nullptr : values->data();
}

void Resize(std::vector<double>* values, std::size_t size) {
  if (values != nullptr) values->resize(size);
}

void SetZero(std::vector<double>* values, std::size_t size) {
  if (values != nullptr) values->assign(size, 0.0);
}

// Zeroes what the terms of a scan will add to: no other scan touches its points.
void ClearPointsOf(const ScanEntry& scan, const EnergyDerivatives& out) {
  const auto clear = [&scan](int size, std::vector<double>* values) {
    if (values == nullptr) return;
    std::fill_n(values->begin() + size * scan.first_return, size * scan.num_returns, 0.0);
  };
  clear(2, out.point_gradient);
  clear(3, out.point_blocks);
}

}  // namespace

double TermCosts::Total() const {
  double total = 0.0;
  for (const double c : cost) total += c;
  return total;
}

Energy::Energy(const SlamGraph& graph, const Associations& associations,
               const FactorOptions& options, ThreadPool* pool)
    : Energy(graph, associations, options, pool, graph.fixed_poses()) {}

Energy::Energy(const SlamGraph& graph, const Associations& associations,
               const FactorOptions& options, ThreadPool* pool, std::vector<FixedPose> constants)
    : graph_(graph),
      associations_(associations),
      options_(options),
      pool_(pool),
      terms_(MakeTerms(graph, associations, options)),
      constants_(std::move(constants)) {}

Energy::Chosen Energy::Choose(const TermChoice& choice) const {
  Chosen chosen;
  for (std::size_t t = 0; t < terms_.size(); ++t) {
    if (choice && !choice(*terms_[t])) continue;
    (terms_[t]->GoesByScan() ? chosen.by_scan : chosen.whole).push_back(t);
  }
  return chosen;
}

// Poses may be shared by scans of different chunks, so scans write to arrays of their own, which
// are added up in order afterwards.
bool Energy::LinearizeScans(std::size_t begin, std::size_t end,
                            const std::vector<std::size_t>& terms, const StateView& at,
                            const EnergyDerivatives& out, std::vector<double>* scan_gradients,
                            std::vector<double>* scan_blocks, double* costs) const {
  TermDerivatives to;
  to.point_gradient = Data(out.point_gradient);
  to.point_blocks = Data(out.point_blocks);
  for (std::size_t s = begin; s < end; ++s) {
    const int scan = static_cast<int>(s);
    ClearPointsOf(graph_.scan(scan), out);
    to.first_pose = graph_.scan(scan).pose;
    if (!scan_gradients->empty()) to.pose_gradient = &(*scan_gradients)[3 * s];
    if (!scan_blocks->empty()) to.pose_blocks = &(*scan_blocks)[6 * s];
    for (const std::size_t t : terms) {
      if (!terms_[t]->Linearize(scan, at, to, &costs[t])) return false;
    }
  }
  return true;
}

bool Energy::Evaluate(const std::vector<double>& poses, const std::vector<double>& points,
                      TermCosts* costs, const EnergyDerivatives& derivatives,
                      const TermChoice& choice) const {
  SetZero(derivatives.pose_gradient, poses.size());
  SetZero(derivatives.pose_blocks, 2 * poses.size());
  Resize(derivatives.point_gradient, points.size());
  Resize(derivatives.point_blocks, points.size() / 2 * 3);
  std::vector<double> scan_gradients(derivatives.pose_gradient ? 3 * graph_.num_scans() : 0);
  std::vector<double> scan_blocks(derivatives.pose_blocks ? 6 * graph_.num_scans() : 0);

  const Chosen chosen = Choose(choice);
  const StateView at{poses.data(), points.data()};
  const std::size_t num_chunks = ThreadPool::NumChunks(graph_.num_scans(), kScansPerChunk);
  std::vector<double> chunk_costs(num_chunks * terms_.size(), 0.0);
  std::vector<char> chunk_ok(num_chunks, false);
  pool_->ForEachChunk(graph_.num_scans(), kScansPerChunk,
                      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                        chunk_ok[chunk] = LinearizeScans(begin, end, chosen.by_scan, at,
                                                         derivatives, &scan_gradients, &scan_blocks,
                                                         &chunk_costs[chunk * terms_.size()]);
                      });

  const TermDerivatives to{0, Data(derivatives.pose_gradient), Data(derivatives.pose_blocks),
                           Data(derivatives.point_gradient), Data(derivatives.point_blocks)};
  costs->cost.assign(terms_.size(), 0.0);
  bool ok = std::find(chunk_ok.begin(), chunk_ok.end(), 0) == chunk_ok.end();
  for (const std::size_t t : chosen.whole) {
    ok = ok && terms_[t]->Linearize(Term::kNoScan, at, to, &costs->cost[t]);
  }
  for (const std::size_t t : chosen.by_scan) {
    double sum = 0.0;
    for (std::size_t chunk = 0; chunk < num_chunks; ++chunk) {
      sum += chunk_costs[chunk * terms_.size() + t];
    }
    costs->cost[t] = SumOverPeers(graph_.peers(), sum);
  }
  if (derivatives.pose_gradient) {
    AddToPoses<3>(graph_, scan_gradients, derivatives.pose_gradient);
    HoldConstants(derivatives.pose_gradient);
  }
  if (derivatives.pose_blocks) AddToPoses<6>(graph_, scan_blocks, derivatives.pose_blocks);
  return ok && std::isfinite(costs->Total());
}

void Energy::HoldConstants(std::vector<double>* gradient) const {
  for (const FixedPose& fixed : constants_) {
    std::fill_n(gradient->begin() + 3 * fixed.pose, 3, 0.0);
  }
}

double Energy::Curvature(const std::vector<double>& poses, const std::vector<double>& points,
                         const std::vector<double>* pose_direction,
                         const std::vector<double>* point_direction,
                         const TermChoice& choice) const {
  const Chosen chosen = Choose(choice);
  const StateView at{poses.data(), points.data()};
  const StateView direction{Data(pose_direction), Data(point_direction)};
  const std::size_t num_chunks = ThreadPool::NumChunks(graph_.num_scans(), kScansPerChunk);
  std::vector<double> sums(num_chunks, 0.0);
  pool_->ForEachChunk(graph_.num_scans(), kScansPerChunk,
                      [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                        double sum = 0.0;
                        for (std::size_t s = begin; s < end; ++s) {
                          for (const std::size_t t : chosen.by_scan) {
                            terms_[t]->AddCurvature(static_cast<int>(s), at, direction, &sum);
                          }
                        }
                        sums[chunk] = sum;
                      });
  double total = 0.0;
  for (const std::size_t t : chosen.whole) {
    if (pose_direction != nullptr || terms_[t]->SeesPoints()) {
      terms_[t]->AddCurvature(Term::kNoScan, at, direction, &total);
    }
  }
  for (const double sum : sums) total += sum;
  return total;
}

void Energy::AddCarriedBlocks(const std::vector<double>& poses, const std::vector<double>& points,
                              std::vector<double>* pose_blocks) const {
  const Chosen chosen = Choose([](const Term& term) { return !term.SeesPoses(); });
  std::vector<double> scan_blocks(6 * graph_.num_scans(), 0.0);
  pool_->ForEachChunk(graph_.num_scans(), kScansPerChunk,
                      [&](std::size_t, std::size_t begin, std::size_t end) {
                        for (std::size_t s = begin; s < end; ++s) {
                          const int scan = static_cast<int>(s);
                          for (const std::size_t t : chosen.by_scan) {
                            terms_[t]->AddCarriedBlock(scan, &poses[3 * graph_.scan(scan).pose],
                                                       points.data(), &scan_blocks[6 * s]);
                          }
                        }
                      });
  AddToPoses<6>(graph_, scan_blocks, pose_blocks);
}

}  // namespace plumbline
