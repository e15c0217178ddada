#include "plumbline/solvers/loop_closure/misplaced_scans.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "plumbline/core/over_peers.h"
#include "plumbline/factors/motion_factor.h"
#include "plumbline/solvers/front_end/local_map.h"
#include "plumbline/solvers/front_end/scan_matcher.h"

namespace plumbline {
namespace {

// A scan that lies farther off than this [m] is misplaced. Steps, so many in a row, whose lengths
// differ from the odometry by as much in all, and by more than noise, ...
constexpr double kMisplacedM = 0.1;
constexpr double kOddSigmas = 4.0;
constexpr std::array<std::size_t, 5> kStepsInARow = {1, 2, 4, 8, 16};
// ... put so many poses on either side of them in doubt.
constexpr int kPosesInDoubt = 16;
// These are compared with what was seen from this near [m], by scans this far apart [m], [rad] on
// their pass, and so many at most.
constexpr double kReferenceReachM = 8.0;
constexpr double kReferenceSpacingM = 0.3;
constexpr double kReferenceSpacingRad = 0.3;
constexpr std::size_t kMostReferences = 400;
// Where a scan belongs, this share of it fits, and so much more than where it is; ...
constexpr double kMinFittingShare = 0.9;
constexpr double kMinFittingMore = 0.05;
// ... and chi-squared, of independent errors, is lower by this. On simulated floors it is by 6 or
// more for scans that are misplaced.
constexpr double kMinRelief = 4.0;
// It is looked for at these distances [m] along the direction in which its pose is known worst,
// either way. What is farther may be the next door that looks alike.
constexpr std::array<double, 5> kStartsM = {0.15, 0.3, 0.45, 0.6, 0.75};
constexpr double kStartGateM = 0.3;
constexpr double kFarthestM = 0.9;
// A series of scans is moved only if its steps then differ from the odometry by no more than
// before, but for this much [m] a scan, as each speaks for it, and for kMisplacedM, by which the
// poses beside it may be off. One that fits at another door by chance would leap there and back.
constexpr double kDifferencePerScanM = 0.05;
// Poses in doubt are compared with the same map if they lie so near to each other in time.
constexpr int kPosesAtATime = 32;

// How much longer than by the odometry the steps are to each pose, from the first one on, and the
// variance of that.
struct Excess {
  double length_m = 0.0, variance_m2 = 0.0;
};

std::vector<Excess> SumExcess(const std::vector<Pose2>& odometry, const MotionOptions& motion,
                              const std::vector<Pose2>& poses) {
  std::vector<Excess> sums(poses.size());
  for (std::size_t p = 1; p < poses.size(); ++p) {
    const Pose2 step = Between(poses[p - 1], poses[p]);
    sums[p].length_m = sums[p - 1].length_m + step.x - odometry[p].x;
    sums[p].variance_m2 = sums[p - 1].variance_m2 + MotionCovariance(odometry[p], motion)(0, 0);
  }
  return sums;
}

// Per pose, whether the step to it is odd: by itself, or else with those around it.
std::vector<char> FindOddSteps(const std::vector<Pose2>& odometry, const MotionOptions& motion,
                               const std::vector<Pose2>& poses) {
  const std::vector<Excess> excess = SumExcess(odometry, motion, poses);
  std::vector<char> is_odd(poses.size(), 0);
  for (const std::size_t num_steps : kStepsInARow) {
    const std::vector<char> known = is_odd;
    std::size_t last_known = 0;
    for (std::size_t to = 1; to < poses.size(); ++to) {
      if (known[to] != 0) last_known = to;
      if (to < num_steps + last_known) continue;
      const std::size_t from = to - num_steps;
      const double off_m = std::abs(excess[to].length_m - excess[from].length_m);
      const double sigma_m = std::sqrt(excess[to].variance_m2 - excess[from].variance_m2);
      if (off_m <= std::max(kMisplacedM, kOddSigmas * sigma_m)) continue;
      std::fill_n(is_odd.begin() + static_cast<std::ptrdiff_t>(from) + 1, num_steps, 1);
    }
  }
  return is_odd;
}

// Per pose, whether it may be misplaced.
std::vector<char> FindDoubts(const std::vector<char>& is_odd) {
  const int num_poses = static_cast<int>(is_odd.size());
  std::vector<char> is_in_doubt(is_odd.size(), 0);
  for (int p = 0; p < num_poses; ++p) {
    if (is_odd[p] == 0) continue;
    std::fill(is_in_doubt.begin() + std::max(0, p - kPosesInDoubt),
              is_in_doubt.begin() + std::min(num_poses, p + kPosesInDoubt), 1);
  }
  return is_in_doubt;
}

// The poses that are not in doubt, apart from each other.
class References {
 public:
  References(const std::vector<int>& scan_of_pose, const std::vector<char>& is_in_doubt,
             const std::vector<Pose2>& poses)
      : poses_(poses) {
    int previous = -1;
    for (int p = 0; p < static_cast<int>(poses.size()); ++p) {
      if (is_in_doubt[p] != 0 || scan_of_pose[p] < 0 || !IsApart(previous, p)) continue;
      by_x_.push_back(p);
      previous = p;
    }
    std::stable_sort(by_x_.begin(), by_x_.end(),
                     [&](int a, int b) { return poses_[a].x < poses_[b].x; });
  }

  // Those near the poses, in order.
  std::vector<int> Near(const std::vector<int>& poses) const {
    Eigen::AlignedBox2d box;
    for (const int p : poses) box.extend(poses_[p].translation());
    std::vector<int> near;
    for (auto pose = std::lower_bound(by_x_.begin(), by_x_.end(), box.min().x() - kReferenceReachM,
                                      [&](int p, double x) { return poses_[p].x < x; });
         pose != by_x_.end() && poses_[*pose].x <= box.max().x() + kReferenceReachM; ++pose) {
      if (box.exteriorDistance(poses_[*pose].translation()) <= kReferenceReachM) {
        near.push_back(*pose);
      }
    }
    std::sort(near.begin(), near.end());
    if (near.size() <= kMostReferences) return near;
    std::vector<int> some;
    for (std::size_t i = 0; i < kMostReferences; ++i) {
      some.push_back(near[i * near.size() / kMostReferences]);
    }
    return some;
  }

 private:
  bool IsApart(int previous, int pose) const {
    if (previous < 0) return true;
    const Pose2 step = Between(poses_[previous], poses_[pose]);
    return step.translation().norm() >= kReferenceSpacingM ||
           std::abs(step.yaw) >= kReferenceSpacingRad;
  }

  const std::vector<Pose2>& poses_;
  std::vector<int> by_x_;
};

ScanMatch MatchFrom(const LocalMap& map, const SurfacePoints& scan, const Pose2& start) {
  ScanMatchOptions options;
  options.coarse_gate_m = kStartGateM;
  PosePrediction prediction;
  prediction.world_from_robot = start;
  return MatchScan(map, scan, prediction, options);
}

bool FitsClearlyBetter(const ScanMatch& match, const ScanMatch& than) {
  return match.inlier_ratio >= kMinFittingShare &&
         match.inlier_ratio >= than.inlier_ratio + kMinFittingMore &&
         than.chi2 - match.chi2 >= kMinRelief * kPointsPerError;
}

Eigen::Vector2d WorstKnownDirection(const ScanMatch& match) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(match.information.topLeftCorner<2, 2>());
  return axes.eigenvectors().col(0);
}

// Twice the negative log likelihood of a scan at the gate that a match begins with.
double CoarseChi2(const LocalMap& map, const SurfacePoints& scan, const Pose2& world_from_robot) {
  ScanMatchOptions options;
  options.fine_gate_m = kStartGateM;
  return MeasureFit(map, scan, world_from_robot, options).chi2;
}

// Whether no match whatever could fit clearly better than this one.
bool NothingFitsBetter(const ScanMatch& match) {
  return match.inlier_ratio > 1.0 - kMinFittingMore || match.chi2 < kMinRelief * kPointsPerError;
}

// Where the scan fits clearly better than where it is, if there is such a place.
std::optional<Pose2> WhereItFits(const LocalMap& map, const SurfacePoints& scan,
                                 const Pose2& world_from_robot) {
  const ScanMatch as_it_is = MeasureFit(map, scan, world_from_robot, ScanMatchOptions());
  if (NothingFitsBetter(as_it_is)) return std::nullopt;
  // From bare walls a match may come to rest anywhere along them: elsewhere must be better than at
  // rest here.
  const ScanMatch at_rest = MatchFrom(map, scan, world_from_robot);
  ScanMatch best = at_rest;
  if (!NothingFitsBetter(at_rest)) {
    const Eigen::Vector2d along = WorstKnownDirection(as_it_is);
    const double chi2_here = CoarseChi2(map, scan, world_from_robot);
    for (const double distance_m : kStartsM) {
      for (const double shift_m : {-distance_m, distance_m}) {
        Pose2 start = world_from_robot;
        start.x += shift_m * along.x();
        start.y += shift_m * along.y();
        // The start next to where the scan belongs fits better than where it is.
        if (CoarseChi2(map, scan, start) >= chi2_here) continue;
        const ScanMatch match = MatchFrom(map, scan, start);
        if (match.chi2 < best.chi2) best = match;
      }
    }
    if (!FitsClearlyBetter(best, at_rest)) best = at_rest;
  }
  const Eigen::Vector2d off = best.world_from_robot.translation() - world_from_robot.translation();
  const bool is_misplaced =
      off.norm() > kMisplacedM && off.norm() <= kFarthestM && FitsClearlyBetter(best, as_it_is);
  return is_misplaced ? std::make_optional(best.world_from_robot) : std::nullopt;
}

// Scans in doubt that this process has, and the poses whose scans they are compared with.
struct Comparison {
  std::vector<int> poses, references;
};

std::vector<Comparison> PlanComparisons(const ScanSurfaces& surfaces,
                                        const std::vector<char>& is_in_doubt,
                                        const std::vector<Pose2>& poses) {
  const SlamGraph& graph = surfaces.graph();
  std::vector<char> is_fixed(poses.size(), 0);
  for (const FixedPose& fixed : graph.fixed_poses()) is_fixed[fixed.pose] = 1;
  std::vector<Comparison> comparisons;
  int begin = -kPosesAtATime;  // of the last comparison
  for (int p = 0; p < static_cast<int>(poses.size()); ++p) {
    if (is_in_doubt[p] == 0 || is_fixed[p] != 0 || surfaces.scan_of_pose()[p] < 0) continue;
    if (p >= begin + kPosesAtATime) {
      comparisons.emplace_back();
      begin = p;
    }
    comparisons.back().poses.push_back(p);
  }
  const References references(surfaces.scan_of_pose(), is_in_doubt, poses);
  std::vector<Comparison> own;
  for (Comparison& comparison : comparisons) {
    std::vector<int>& of_all = comparison.poses;
    // The same map whoever has the scans.
    comparison.references = references.Near(of_all);
    of_all.erase(
        std::remove_if(of_all.begin(), of_all.end(), [&](int p) { return !graph.HasScansOf(p); }),
        of_all.end());
    if (!of_all.empty()) own.push_back(std::move(comparison));
  }
  return own;
}

LocalMap MapOf(const ScanSurfaces& surfaces, const std::vector<int>& references,
               const std::vector<Pose2>& poses) {
  std::vector<SurfacePoints> scans;
  std::vector<Pose2> places;
  for (const int pose : references) {
    scans.push_back(surfaces.Of(surfaces.scan_of_pose()[pose]));
    places.push_back(poses[pose]);
  }
  std::vector<const SurfacePoints*> pointers(scans.size());
  std::transform(scans.begin(), scans.end(), pointers.begin(),
                 [](const SurfacePoints& scan) { return &scan; });
  LocalMap map;
  map.Rebuild(pointers, places);
  return map;
}

// By how much steps, first to last, are longer or shorter than by the odometry, in all [m].
double SumDifferences(int first, int last, const std::vector<Pose2>& odometry,
                      const std::vector<Pose2>& poses) {
  double sum_m = 0.0;
  for (int p = std::max(1, first); p <= last && p < static_cast<int>(poses.size()); ++p) {
    sum_m += std::abs(Between(poses[p - 1], poses[p]).x - odometry[p].x);
  }
  return sum_m;
}

// Leaves out what would make the robot leap there and back.
std::vector<MisplacedScan> WithoutLeaps(const std::vector<MisplacedScan>& scans,
                                        const std::vector<Pose2>& odometry,
                                        std::vector<Pose2> poses) {
  std::vector<MisplacedScan> kept;
  for (auto begin = scans.begin(); begin != scans.end();) {
    auto end = begin + 1;
    while (end != scans.end() && end->pose == (end - 1)->pose + 1) ++end;
    const int first = begin->pose, last_step = (end - 1)->pose + 1;
    const std::vector<Pose2> before(poses.begin() + first, poses.begin() + last_step);
    const double before_m = SumDifferences(first, last_step, odometry, poses);
    for (auto scan = begin; scan != end; ++scan) poses[scan->pose] = scan->world_from_robot;
    const double after_m = SumDifferences(first, last_step, odometry, poses);
    const double allowed_m = kMisplacedM + kDifferencePerScanM * static_cast<double>(end - begin);
    if (after_m <= before_m + allowed_m) {
      kept.insert(kept.end(), begin, end);
    } else {
      std::copy(before.begin(), before.end(), poses.begin() + first);
    }
    begin = end;
  }
  return kept;
}

}  // namespace

std::vector<MisplacedScan> FindMisplacedScans(const ScanSurfaces& surfaces,
                                              const std::vector<Pose2>& odometry,
                                              const MotionOptions& motion,
                                              const std::vector<Pose2>& world_from_robot,
                                              ThreadPool* pool) {
  const std::vector<Comparison> comparisons = PlanComparisons(
      surfaces, FindDoubts(FindOddSteps(odometry, motion, world_from_robot)), world_from_robot);
  std::vector<int> references;
  for (const Comparison& comparison : comparisons) {
    for (const int pose : comparison.references) {
      references.push_back(surfaces.scan_of_pose()[pose]);
    }
  }
  const ScanSurfaces known = surfaces.With(references);
  std::vector<std::vector<MisplacedScan>> found(comparisons.size());
  pool->ForEachChunk(comparisons.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    const LocalMap map = MapOf(known, comparisons[i].references, world_from_robot);
    for (const int pose : comparisons[i].poses) {
      const SurfacePoints scan = known.Of(known.scan_of_pose()[pose]);
      const std::optional<Pose2> place = WhereItFits(map, scan, world_from_robot[pose]);
      if (place) found[i].push_back({pose, *place});
    }
  });
  std::vector<MisplacedScan> own;
  for (const std::vector<MisplacedScan>& of_this : found) {
    own.insert(own.end(), of_this.begin(), of_this.end());
  }
  std::vector<MisplacedScan> all = JoinOverPeers(surfaces.graph().peers(), std::move(own));
  std::sort(all.begin(), all.end(),
            [](const MisplacedScan& a, const MisplacedScan& b) { return a.pose < b.pose; });
  return WithoutLeaps(all, odometry, world_from_robot);
}

}  // namespace plumbline
