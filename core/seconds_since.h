#ifndef PLUMBLINE_CORE_SECONDS_SINCE_H_
#define PLUMBLINE_CORE_SECONDS_SINCE_H_

#include <chrono>

namespace plumbline {

/// Wall time that has passed [s].
inline double SecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_SECONDS_SINCE_H_
