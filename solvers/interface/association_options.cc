#include "plumbline/solvers/interface/association_options.h"

#include "plumbline/core/options_check.h"

namespace plumbline {

const char* ToString(NeighborhoodType type) {
  return type == NeighborhoodType::kRadius ? "radius" : "nearest";
}

bool FromString(const std::string& name, NeighborhoodType* type) {
  for (const NeighborhoodType candidate : {NeighborhoodType::kRadius, NeighborhoodType::kNearest}) {
    if (name == ToString(candidate)) {
      *type = candidate;
      return true;
    }
  }
  return false;
}

bool AssociationOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(min_points, 3, 1000);
  PLUMBLINE_CHECK_OPTION_WITHIN(landmark_size_m, 1e-3, 100.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(max_points, min_points, 1000);
  PLUMBLINE_CHECK_OPTION_WITHIN(max_eigenvalue_ratio, 1e-6, 1.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(min_segment_length_m, 1e-3, 100.0);
  PLUMBLINE_CHECK_OPTION(shape_margin_rad, >=, 1e-6);
  PLUMBLINE_CHECK_OPTION(shape_margin_rad, <, 0.7853981633974483);
  return true;
}

}  // namespace plumbline
