#include "plumbline/solvers/interface/seeding_options.h"

#include "plumbline/core/options_check.h"

namespace plumbline {

bool SequentialSeedingOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(keyframe_distance_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(keyframe_angle_rad, >, 0.0);
  return true;
}

bool SeedingOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(sequential);
  return true;
}

}  // namespace plumbline
