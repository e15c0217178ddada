#ifndef PLUMBLINE_CORE_MEDIAN_H_
#define PLUMBLINE_CORE_MEDIAN_H_

#include <algorithm>
#include <cstddef>
#include <vector>

namespace plumbline {

/// The middle of the values in order of size, the larger one of two; needs a value, and numbers.
inline double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_MEDIAN_H_
