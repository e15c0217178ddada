#include "plumbline/solvers/front_end/match_profile.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"

namespace plumbline {
namespace {

// Distances along the direction [m], either way: apart by a maximum's width at first.
constexpr std::array<double, 9> kShiftsM = {0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.3, 1.6};
// Chi-squared relative to the best pose from which on the profile ends, ...
constexpr double kNegligible = 16.0;
// ... and up to which it may go on beyond its ends.
constexpr double kUnlikely = 6.0;
// Largest correction of the pose [m]: places farther away are tried by the search.
constexpr double kFarthestMoveM = 0.6;
// Information that holds a pose along one direction to a fraction of a millimetre [1/m^2].
constexpr double kHeld = 1e7;
// Across a corridor, the poses along it differ by millimetres.
constexpr int kIterationsHeld = 3;

struct Sample {
  double shift_m = 0.0;
  ScanMatch match;
};

bool IsLessLikely(const Sample& a, const Sample& b) { return a.match.chi2 > b.match.chi2; }

// Difference in chi-squared of independent errors.
double WorseBy(const Sample& sample, const Sample& best) {
  return (sample.match.chi2 - best.match.chi2) / kPointsPerError;
}

class Profile {
 public:
  // along: unit vector in the frame of the map.
  Profile(const LocalMap& map, const SurfacePoints& scan, const ScanMatchOptions& options,
          const ScanMatch& match, const Eigen::Vector2d& along)
      : map_(map), scan_(scan), at_fine_gate_(options), along_(along) {
    at_fine_gate_.coarse_gate_m = options.fine_gate_m;
    const Eigen::Vector2d in_robot = Pose2(0.0, 0.0, -match.world_from_robot.yaw) * along;
    held_information_.topLeftCorner<2, 2>() = kHeld * in_robot * in_robot.transpose();
    best_ = {0.0, match};
    samples_.push_back(best_);
    AddSamples(-1.0);
    std::reverse(samples_.begin(), samples_.end());
    AddSamples(1.0);
  }

  // The most likely pose near the match, free to come to rest between the samples.
  ScanMatch Best() const {
    const Sample* best = nullptr;
    for (const Sample& sample : samples_) {
      if (std::abs(sample.shift_m) > kFarthestMoveM) continue;
      if (best == nullptr || IsLessLikely(*best, sample)) best = &sample;
    }
    PosePrediction start;
    start.world_from_robot = best->match.world_from_robot;
    const ScanMatch rested = MatchScan(map_, scan_, start, at_fine_gate_);
    return rested.chi2 < best->match.chi2 ? rested : best->match;
  }

  // Whether the most likely poses lie between its ends.
  bool FallsOff() const {
    return WorseBy(samples_.front(), best_) > kUnlikely &&
           WorseBy(samples_.back(), best_) > kUnlikely;
  }

  // Second moments (x, y [m], yaw [rad]) of its poses about this one, by the trapezoidal rule.
  Eigen::Matrix3d MomentsAbout(const Pose2& pose) const {
    double total = 0.0;
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const double width_m = samples_[std::min(i + 1, samples_.size() - 1)].shift_m -
                             samples_[i == 0 ? 0 : i - 1].shift_m;
      const double weight = width_m * std::exp(-0.5 * WorseBy(samples_[i], best_));
      const Pose2& sample = samples_[i].match.world_from_robot;
      const Eigen::Vector3d off(sample.x - pose.x, sample.y - pose.y,
                                NormalizeAngle(sample.yaw - pose.yaw));
      total += weight;
      moments += weight * off * off.transpose();
    }
    return moments / total;
  }

 private:
  void AddSamples(double way) {
    for (const double distance_m : kShiftsM) {
      samples_.push_back({way * distance_m, MatchHeldAt(way * distance_m, samples_.back())});
      if (IsLessLikely(best_, samples_.back())) best_ = samples_.back();
      if (WorseBy(samples_.back(), best_) > kNegligible) break;
    }
  }

  // neighbour: the next sample, from which the iterations start.
  ScanMatch MatchHeldAt(double shift_m, const Sample& neighbour) const {
    const Eigen::Vector2d step = (shift_m - neighbour.shift_m) * along_;
    PosePrediction held;
    held.information = held_information_;
    held.world_from_robot = neighbour.match.world_from_robot;
    held.world_from_robot.x += step.x();
    held.world_from_robot.y += step.y();
    ScanMatchOptions options = at_fine_gate_;
    options.max_iterations = kIterationsHeld;
    return MatchScan(map_, scan_, held, options);
  }

  const LocalMap& map_;
  const SurfacePoints& scan_;
  ScanMatchOptions at_fine_gate_;
  Eigen::Vector2d along_;
  Eigen::Matrix3d held_information_ = Eigen::Matrix3d::Zero();  // in the frame of the robot
  std::vector<Sample> samples_;                                 // by shift
  Sample best_;
};

}  // namespace

Eigen::Matrix3d ProfileMatch(const LocalMap& map, const SurfacePoints& scan,
                             const ScanMatchOptions& options, ScanMatch* match) {
  Eigen::Matrix3d by_information = MatchCovariance(match->information);
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(by_information.topLeftCorner<2, 2>());
  const Eigen::Vector2d along = axes.eigenvectors().col(1);
  const Profile profile(map, scan, options, *match, along);
  const bool falls_off = profile.FallsOff();
  const double reach_m = kShiftsM.back();
  if (!falls_off && axes.eigenvalues()(1) > reach_m * reach_m) return by_information;
  *match = profile.Best();
  Eigen::Matrix3d at_rest = MatchCovariance(match->information);
  if (falls_off) {
    // As observed by the samples: a maximum is not much wider than their distance.
    const double spacing_m = kShiftsM.front();
    const Eigen::Vector3d axis(along.x(), along.y(), 0.0);
    at_rest = (at_rest.inverse() + axis * axis.transpose() / (spacing_m * spacing_m)).inverse();
  }
  const Eigen::Matrix3d covariance = at_rest + profile.MomentsAbout(match->world_from_robot);
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace plumbline
