#ifndef PLUMBLINE_CORE_SORT_UNIQUE_H_
#define PLUMBLINE_CORE_SORT_UNIQUE_H_

#include <algorithm>
#include <vector>

namespace plumbline {

/// Sorts values in ascending order and keeps one of each.
template <typename T>
void SortUnique(std::vector<T>* values) {
  std::sort(values->begin(), values->end());
  values->erase(std::unique(values->begin(), values->end()), values->end());
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_SORT_UNIQUE_H_
