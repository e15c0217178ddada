#include "plumbline/solvers/interface/odometry_report.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

bool ClockOffset::IsSignificant() const {
  constexpr double kLeastS = 0.01;
  return sigma_s > 0.0 && std::abs(value_s) > std::max(kLeastS, 4.0 * sigma_s);
}

bool SystematicError::IsSignificant() const {
  return std::abs(value) > 4.0 * sigma && std::abs(value) < 0.5;
}

}  // namespace plumbline
