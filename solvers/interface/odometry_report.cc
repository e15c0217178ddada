#include "plumbline/solvers/interface/odometry_report.h"

#include <cmath>

namespace plumbline {

bool SystematicError::IsSignificant() const {
  return std::abs(value) > 4.0 * sigma && std::abs(value) < 0.5;
}

}  // namespace plumbline
