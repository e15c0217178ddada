#include "plumbline/solvers/interface/seeding_options.h"

#include <algorithm>
#include <iterator>

#include "plumbline/core/options_check.h"

namespace plumbline {

namespace {

constexpr const char* kStartNames[] = {"odometry", "icp", "icp_point_to_line", "icp_global",
                                       "seed"};

}  // namespace

const char* ToString(StartType type) { return kStartNames[static_cast<int>(type)]; }

bool FromString(const std::string& name, StartType* type) {
  const auto* found = std::find(std::begin(kStartNames), std::end(kStartNames), name);
  if (found == std::end(kStartNames)) return false;
  *type = static_cast<StartType>(found - std::begin(kStartNames));
  return true;
}

bool SeedingOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(keyframe_distance_m, 1e-3, 100.0);
  return true;
}

}  // namespace plumbline
