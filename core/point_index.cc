#include "plumbline/core/point_index.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

namespace plumbline {
namespace {

using Neighbor = PointIndex::Neighbor;

struct IsNearer {
  bool operator()(const Neighbor& a, const Neighbor& b) const {
    return a.squared_distance < b.squared_distance ||
           (a.squared_distance == b.squared_distance && a.point < b.point);
  }
};

// The tree's view of the points. [m]
struct FlatPoints {
  std::vector<double> xy;

  std::size_t kdtree_get_point_count() const { return xy.size() / 2; }
  double kdtree_get_pt(std::size_t index, std::size_t axis) const { return xy[2 * index + axis]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, FlatPoints>,
                                                 FlatPoints, 2, std::uint32_t>;

// Collects what a search of the tree comes upon: the `capacity` nearest points of those nearer than
// `limit`. Up to twice as many wait until the farther half is dropped: cheaper than a heap. The
// names of the members are what nanoflann asks for.
class NearestPoints {
 public:
  using DistanceType = double;

  NearestPoints(std::size_t capacity, double limit, std::vector<Neighbor>* found)
      : capacity_(capacity), worst_(limit), found_(*found) {
    found_.clear();
  }

  std::size_t size() const { return found_.size(); }
  bool full() const { return found_.size() >= capacity_; }
  double worstDist() const { return worst_; }

  bool addPoint(double squared_distance, std::uint32_t point) {
    // The tree compares with a value of worstDist() that may have grown old.
    if (!(squared_distance < worst_)) return true;
    found_.push_back({squared_distance, point});
    if (found_.size() == 2 * capacity_) DropFarther();
    return true;
  }

  void sort() {
    if (found_.size() > capacity_) DropFarther();
    std::sort(found_.begin(), found_.end(), IsNearer());
  }

 private:
  void DropFarther() {
    const auto last = found_.begin() + static_cast<std::ptrdiff_t>(capacity_ - 1);
    std::nth_element(found_.begin(), last, found_.end(), IsNearer());
    worst_ = last->squared_distance;
    found_.resize(capacity_);
  }

  std::size_t capacity_;
  double worst_;
  std::vector<Neighbor>& found_;
};

}  // namespace

struct PointIndex::Impl {
  explicit Impl(std::vector<double> xy) : points{std::move(xy)}, tree(2, points) {}

  void Search(const Eigen::Vector2d& query, std::size_t capacity, double limit,
              std::vector<Neighbor>* neighbors) const {
    NearestPoints nearest(capacity, limit, neighbors);
    tree.findNeighbors(nearest, query.data(), {});
    nearest.sort();
  }

  FlatPoints points;
  Tree tree;
};

PointIndex::PointIndex(std::vector<double> points) : impl_(new Impl(std::move(points))) {}
PointIndex::~PointIndex() = default;
PointIndex::PointIndex(PointIndex&&) noexcept = default;
PointIndex& PointIndex::operator=(PointIndex&&) noexcept = default;

std::size_t PointIndex::size() const { return impl_->points.kdtree_get_point_count(); }

void PointIndex::FindNearest(const Eigen::Vector2d& query, std::size_t count,
                             std::vector<Neighbor>* neighbors) const {
  neighbors->clear();
  if (count == 0) return;
  impl_->Search(query, std::min(count, size()), std::numeric_limits<double>::infinity(), neighbors);
}

void PointIndex::FindWithin(const Eigen::Vector2d& query, double radius_m,
                            std::vector<Neighbor>* neighbors) const {
  // The search takes what is nearer than its limit.
  const double limit = std::nextafter(radius_m * radius_m, std::numeric_limits<double>::infinity());
  impl_->Search(query, size() + 1, limit, neighbors);
}

}  // namespace plumbline
