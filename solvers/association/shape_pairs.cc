// Which pieces of surface are expected to be parallel or orthogonal: neighbours along a scan.
//
// A scan falls into runs of consecutive returns that one surface joins and that have compatible
// normals. Each run is cut into regions as short as kShapeRegionM allows; the last one takes
// the rest. Regions are disjoint, so that a return takes part in one segment at most. Two regions
// are adjacent if they follow each other in a run, or, around a corner, where returns have no
// normal, if joined returns lead from one to the other over no more than kShapeRegionM.
// Regions depend on the measurements alone and stay the same while the map moves; which pairs are
// parallel or orthogonal is seen on the current map.

#include <algorithm>
#include <cmath>

#include "plumbline/core/joined_returns.h"
#include "plumbline/solvers/association/associations.h"

namespace plumbline {
namespace {

// Largest angle [rad] between normals of one region, 60 degrees.
constexpr double kMaxNormalAngleRad = 1.0471975511965976;

// Consecutive returns [first, last] of one scan, counted from its first return.
struct Region {
  std::size_t first = 0, last = 0;
  bool follows = false;  // adjacent to the region before it
};

class ScanShapePairs {
 public:
  ScanShapePairs(const SlamGraph& graph, const std::vector<double>& points,
                 const std::vector<ReturnNormal>& normals)
      : graph_(graph),
        points_(points),
        normals_(normals),
        min_normal_cosine_(std::cos(kMaxNormalAngleRad)) {}

  /// Appends the pairs of one scan in order of its beams.
  void Find(int scan_id, std::vector<ShapePair>* pairs) {
    first_return_ = graph_.scan(scan_id).first_return;
    MeasuredPoints(graph_, scan_id, &measured_);
    // A step that is small beside a region does not part two regions.
    FindJoinedReturns(graph_, scan_id, measured_, 0.5 * kShapeRegionM, &joined_);
    CutRegions();
    for (std::size_t i = 1; i < regions_.size(); ++i) {
      ShapePair pair;
      if (regions_[i].follows && MakePair(regions_[i - 1], regions_[i], &pair)) {
        pairs->push_back(pair);
      }
    }
  }

 private:
  void CutRegions() {
    regions_.clear();
    linked_ = false;
    for (std::size_t k = 0; k < measured_.size();) {
      linked_ = linked_ && joined_[k];
      const std::size_t end = EndOfRun(k);
      if (end > k) CutRun(k, end);
      k = std::max(end, k + 1);
    }
  }

  // One past the last return of the run that begins at `first`; `first` itself if there is none.
  std::size_t EndOfRun(std::size_t first) const {
    std::size_t k = first;
    while (k < measured_.size() && !NormalOf(k).IsNone() &&
           (k == first || (joined_[k] && NormalOf(k - 1).Direction().dot(NormalOf(k).Direction()) >=
                                             min_normal_cosine_))) {
      ++k;
    }
    return k;
  }

  void CutRun(std::size_t begin, std::size_t end) {
    const std::size_t regions_before = regions_.size();
    Region region;
    region.first = begin;
    region.follows = linked_ && Distance(regions_.back().last, begin) <= kShapeRegionM;
    for (std::size_t k = begin; k < end; ++k) {
      if (Distance(region.first, k) < kShapeRegionM) continue;
      region.last = k;
      regions_.push_back(region);
      region.first = k + 1;
      region.follows = true;
    }
    if (regions_.size() == regions_before) return;
    regions_.back().last = end - 1;
    linked_ = true;
  }

  // The segment of `region` against that of the region after it.
  bool MakePair(const Region& region, const Region& next, ShapePair* pair) const {
    pair->previous = first_return_ + region.first;
    pair->current = first_return_ + region.last;
    pair->adjacent_previous = first_return_ + next.first;
    pair->adjacent_current = first_return_ + next.last;
    return ClassifyShape(MapSegmentNormal(region), MapSegmentNormal(next), kShapeMarginRad,
                         &pair->category);
  }

  Eigen::Vector2d MapSegmentNormal(const Region& region) const {
    return SegmentNormal(MapPoint(region.first), MapPoint(region.last));
  }
  Eigen::Vector2d MapPoint(std::size_t k) const {
    return Eigen::Map<const Eigen::Vector2d>(&points_[2 * (first_return_ + k)]);
  }
  ReturnNormal NormalOf(std::size_t k) const { return normals_[first_return_ + k]; }
  double Distance(std::size_t a, std::size_t b) const {
    return (measured_[a] - measured_[b]).norm();
  }

  const SlamGraph& graph_;
  const std::vector<double>& points_;
  const std::vector<ReturnNormal>& normals_;
  const double min_normal_cosine_;
  // Of the current scan.
  std::size_t first_return_ = 0;
  std::vector<Eigen::Vector2d> measured_;  // ends of the beams, frame of the robot
  std::vector<bool> joined_;
  std::vector<Region> regions_;
  bool linked_ = false;  // joined returns lead here from the last region
};

}  // namespace

std::vector<ShapePair> FindShapePairs(const SlamGraph& graph, const std::vector<double>& points,
                                      const std::vector<ReturnNormal>& normals, ThreadPool* pool) {
  constexpr std::size_t kScansPerChunk = 64;
  const std::size_t num_scans = graph.num_scans();
  std::vector<std::vector<ShapePair>> chunks(ThreadPool::NumChunks(num_scans, kScansPerChunk));
  pool->ForEachChunk(num_scans, kScansPerChunk,
                     [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                       ScanShapePairs finder(graph, points, normals);
                       for (std::size_t s = begin; s < end; ++s) {
                         finder.Find(static_cast<int>(s), &chunks[chunk]);
                       }
                     });
  std::vector<ShapePair> pairs;
  for (const std::vector<ShapePair>& chunk : chunks) {
    pairs.insert(pairs.end(), chunk.begin(), chunk.end());
  }
  return pairs;
}

}  // namespace plumbline
