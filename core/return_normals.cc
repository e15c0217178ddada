#include "plumbline/core/return_normals.h"

#include <cstddef>

#include "plumbline/core/joined_returns.h"
#include "plumbline/core/line_fit.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

class ScanNormalEstimator {
 public:
  ScanNormalEstimator(const SlamGraph& graph, const ReturnNormalOptions& options)
      : graph_(graph), options_(options) {}

  void EstimateScan(int scan_id, std::vector<ReturnNormal>* normals) {
    const ScanEntry& scan = graph_.scan(scan_id);
    laser_in_robot_ = graph_.laser(scan.laser).robot_from_laser.translation();
    MeasuredPoints(graph_, scan_id, &points_);
    FindJoinedReturns(graph_, scan_id, points_, options_.half_window_m, &joined_);
    for (std::size_t k = 0; k < scan.num_returns; ++k) {
      const std::size_t r = scan.first_return + k;
      (*normals)[r] = graph_.Moves(r) ? ReturnNormal() : NormalOf(k);
    }
  }

 private:
  ReturnNormal NormalOf(std::size_t k) const {
    const Eigen::Vector2d center = points_[k];
    const double window_squared = options_.half_window_m * options_.half_window_m;
    PointMoments moments;
    moments.Add(0.0, 0.0);
    int count = 1;
    // Next neighbours count however far they are: beyond some range the window holds no others.
    const auto add = [&](std::size_t j, bool next) {
      const Eigen::Vector2d offset = points_[j] - center;
      if (!next && offset.squaredNorm() > window_squared) return false;
      moments.Add(offset.x(), offset.y());
      ++count;
      return true;
    };
    for (std::size_t j = k; j > 0 && joined_[j]; --j) {
      if (!add(j - 1, j == k)) break;
    }
    for (std::size_t j = k + 1; j < points_.size() && joined_[j]; ++j) {
      if (!add(j, j == k + 1)) break;
    }
    if (count < 3) return ReturnNormal();
    const LineFit fit = FitLine(moments);
    if (fit.EigenvalueRatio() > kMaxEigenvalueRatio) return ReturnNormal();
    const bool faces_laser = fit.normal.dot(laser_in_robot_ - center) >= 0.0;
    return ReturnNormal(faces_laser ? fit.normal : Eigen::Vector2d(-fit.normal));
  }

  const SlamGraph& graph_;
  const ReturnNormalOptions& options_;
  Eigen::Vector2d laser_in_robot_;
  std::vector<Eigen::Vector2d> points_;  // of one scan, in the frame of the robot
  std::vector<bool> joined_;             // to the return before it, by one surface
};

}  // namespace

bool ReturnNormalOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(half_window_m, >, 0.0);
  return true;
}

void ExtendReturnNormals(const SlamGraph& graph, int first_scan, const ReturnNormalOptions& options,
                         ThreadPool* pool, std::vector<ReturnNormal>* normals) {
  normals->resize(graph.num_returns());
  constexpr std::size_t kScansPerChunk = 16;
  pool->ForEachChunk(graph.num_scans() - first_scan, kScansPerChunk,
                     [&](std::size_t, std::size_t begin, std::size_t end) {
                       ScanNormalEstimator estimator(graph, options);
                       for (std::size_t s = begin; s < end; ++s) {
                         estimator.EstimateScan(first_scan + static_cast<int>(s), normals);
                       }
                     });
}

void DropMovingNormals(const SlamGraph& graph, std::vector<ReturnNormal>* normals) {
  for (std::size_t r = 0; r < normals->size(); ++r) {
    if (graph.Moves(r)) (*normals)[r] = ReturnNormal();
  }
}

}  // namespace plumbline
