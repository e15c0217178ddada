#ifndef PLUMBLINE_CORE_MEDIAN_H_
#define PLUMBLINE_CORE_MEDIAN_H_

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace plumbline {

/// The value that this share of the values, from 0 to less than 1, comes before in order of size;
/// needs a value, and numbers.
inline double Quantile(std::vector<double> values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// The middle of the values in order of size, the larger one of two; needs a value, and numbers.
inline double Median(std::vector<double> values) { return Quantile(std::move(values), 0.5); }

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_MEDIAN_H_
