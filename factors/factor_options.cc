#include "plumbline/factors/factor_options.h"

#include "plumbline/core/options_check.h"
#include "plumbline/factors/own_term.h"

namespace plumbline {

bool MotionOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(rotation_per_rotation, >=, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(rotation_per_translation_rad_m, >=, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(translation_per_translation, >=, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(translation_per_rotation_m_rad, >=, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(translation_floor_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(rotation_floor_rad, >, 0.0);
  return true;
}

bool RangeBeamOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(sigma_range_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(sigma_bearing_rad, >, 0.0);
  return true;
}

bool ManifoldOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(sigma_m, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(robust_gate_sigmas, >, 0.0);
  return true;
}

bool ShapeOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(sigma_rad, >, 0.0);
  PLUMBLINE_CHECK_FINITE_OPTION(robust_gate_sigmas, >, 0.0);
  return true;
}

bool DownweightedStep::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(sigma_factor, >, 0.0);
  return true;
}

bool FactorOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(motion);
  PLUMBLINE_CHECK_NESTED_OPTIONS(beam);
  PLUMBLINE_CHECK_NESTED_OPTIONS(manifold);
  PLUMBLINE_CHECK_NESTED_OPTIONS(shape);
  for (const DownweightedStep& downweighted : downweighted_steps) {
    if (!downweighted.Check(error)) return false;
  }
  for (const std::shared_ptr<const OwnTerm>& term : own_terms) {
    PLUMBLINE_CHECK_OPTION(term, !=, nullptr);
    if (!term->Check(error)) return false;
  }
  return true;
}

}  // namespace plumbline
