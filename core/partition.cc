#include "plumbline/core/partition.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

namespace plumbline {
namespace {

class Bisection {
 public:
  Bisection(const std::vector<double>& places, const std::vector<std::size_t>& weights)
      : places_(places), weights_(weights), order_(weights.size()), part_(weights.size(), 0) {
    std::iota(order_.begin(), order_.end(), 0);
  }

  std::vector<int> Divide(int num_parts) {
    Divide(0, order_.size(), 0, num_parts);
    return std::move(part_);
  }

 private:
  double Coordinate(int place, int axis) const { return places_[3 * place + axis]; }

  // Those of order_[begin, end) go to the parts from first_part on.
  void Divide(std::size_t begin, std::size_t end, int first_part, int num_parts) {
    if (num_parts == 1) {
      for (std::size_t i = begin; i < end; ++i) part_[order_[i]] = first_part;
      return;
    }
    const int axis = Length(begin, end, 0) >= Length(begin, end, 1) ? 0 : 1;
    std::sort(order_.begin() + static_cast<std::ptrdiff_t>(begin),
              order_.begin() + static_cast<std::ptrdiff_t>(end), [this, axis](int a, int b) {
                return std::pair(Coordinate(a, axis), a) < std::pair(Coordinate(b, axis), b);
              });
    const int num_first = num_parts / 2;
    const std::size_t middle = Middle(begin, end, num_first, num_parts);
    Divide(begin, middle, first_part, num_first);
    Divide(middle, end, first_part + num_first, num_parts - num_first);
  }

  double Length(std::size_t begin, std::size_t end, int axis) const {
    if (begin == end) return 0.0;
    double low = Coordinate(order_[begin], axis), high = low;
    for (std::size_t i = begin; i < end; ++i) {
      low = std::min(low, Coordinate(order_[i], axis));
      high = std::max(high, Coordinate(order_[i], axis));
    }
    return high - low;
  }

  // Before it lies num_first / num_parts of the weight, as near as can be.
  std::size_t Middle(std::size_t begin, std::size_t end, int num_first, int num_parts) const {
    double total = 0.0, before = 0.0;
    for (std::size_t i = begin; i < end; ++i) total += Weight(i);
    const double wanted = total * num_first / num_parts;
    std::size_t middle = begin;
    while (middle < end && before + 0.5 * Weight(middle) < wanted) before += Weight(middle++);
    return middle;
  }
  double Weight(std::size_t i) const { return static_cast<double>(weights_[order_[i]]); }

  const std::vector<double>& places_;
  const std::vector<std::size_t>& weights_;
  std::vector<int> order_;
  std::vector<int> part_;
};

}  // namespace

std::vector<int> PartitionByPlace(const std::vector<double>& places,
                                  const std::vector<std::size_t>& weights, int num_parts) {
  return Bisection(places, weights).Divide(num_parts);
}

std::vector<int> PartitionByTime(int num_places, int num_parts) {
  std::vector<int> part(num_places);
  const auto border = [&](int i) {
    return part.begin() +
           static_cast<std::ptrdiff_t>(static_cast<std::int64_t>(num_places) * i / num_parts);
  };
  for (int i = 0; i < num_parts; ++i) std::fill(border(i), border(i + 1), i);
  return part;
}

std::vector<std::size_t> ReturnsPerPose(const SlamGraph& graph) {
  std::vector<std::size_t> num_returns(graph.num_poses());
  for (const ScanEntry& scan : graph.all_scans()) num_returns[scan.pose] += scan.num_returns;
  return num_returns;
}

}  // namespace plumbline
