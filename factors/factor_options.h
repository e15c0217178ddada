#ifndef PLUMBLINE_FACTORS_FACTOR_OPTIONS_H_
#define PLUMBLINE_FACTORS_FACTOR_OPTIONS_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/options_check.h"

namespace plumbline {

/// Noise of the rotation-translation-rotation motion model (Thrun, Burgard, Fox: Probabilistic
/// Robotics, ch. 5.4): standard deviations that grow with what was driven, plus a floor.
/// Defaults suit wheel odometry of a few per cent in distance; rotation is loose on purpose, since
/// a stiff heading bends corridors. Each alpha is up to 1e6: noise of a million times the motion
/// is that of odometry that knows nothing. The floors are from 1e-9, as the standard deviations of
/// relative poses, to 1000 m and rad, which switches the odometry off.
struct MotionOptions {
  double rotation_per_rotation = 0.5;           ///< alpha_1 [rad per rad]
  double rotation_per_translation_rad_m = 0.6;  ///< alpha_2 [rad per m]
  double translation_per_translation = 0.2;     ///< alpha_3 [m per m]
  double translation_per_rotation_m_rad = 0.1;  ///< alpha_4 [m per rad]
  double translation_floor_m = 0.01;            ///< at standstill [m]
  double rotation_floor_rad = 0.005;            ///< at standstill [rad]

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_OPTION_WITHIN(rotation_per_rotation, 0.0, 1e6);
    PLUMBLINE_CHECK_OPTION_WITHIN(rotation_per_translation_rad_m, 0.0, 1e6);
    PLUMBLINE_CHECK_OPTION_WITHIN(translation_per_translation, 0.0, 1e6);
    PLUMBLINE_CHECK_OPTION_WITHIN(translation_per_rotation_m_rad, 0.0, 1e6);
    PLUMBLINE_CHECK_OPTION_WITHIN(translation_floor_m, 1e-9, 1000.0);
    PLUMBLINE_CHECK_OPTION_WITHIN(rotation_floor_rad, 1e-9, 1000.0);
    return true;
  }
};

/// A field of MotionOptions, for what treats all of them alike.
struct MotionField {
  const char* name;              ///< as the field is spelled
  const char* unit;              ///< for texts
  double MotionOptions::*value;  ///< the field
};
/// All fields of MotionOptions, in order.
constexpr MotionField kMotionFields[] = {
    {"rotation_per_rotation", "rad per rad", &MotionOptions::rotation_per_rotation},
    {"rotation_per_translation_rad_m", "rad per m", &MotionOptions::rotation_per_translation_rad_m},
    {"translation_per_translation", "m per m", &MotionOptions::translation_per_translation},
    {"translation_per_rotation_m_rad", "m per rad", &MotionOptions::translation_per_rotation_m_rad},
    {"translation_floor_m", "m", &MotionOptions::translation_floor_m},
    {"rotation_floor_rad", "rad", &MotionOptions::rotation_floor_rad},
};

/// Noise of a single laser beam. Defaults: SICK LMS class. From 1e-9, as in MotionOptions, to 10 m
/// and 1 rad: what is further off is no laser.
struct RangeBeamOptions {
  double sigma_range_m = 0.012;      ///< along the beam [m]
  double sigma_bearing_rad = 0.003;  ///< across the beam, its divergence included [rad]

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_OPTION_WITHIN(sigma_range_m, 1e-9, 10.0);
    PLUMBLINE_CHECK_OPTION_WITHIN(sigma_bearing_rad, 1e-9, 1.0);
    return true;
  }
};

/// Manifold potential: how far a point may lie from its tangent line.
struct ManifoldOptions {
  /// Thickness of a surface [m]; from 1e-9 to 1000, which switches the term off.
  double sigma_m = 0.008;
  /// Geman-McClure scale, in standard deviations; infinity: Gaussian. Real surfaces have long tails
  /// (frames, handles, cables): a tighter gate throws away what they know. At least 0.1: below it,
  /// sound points are outliers. Shape terms have three quarters of it.
  double robust_gate_sigmas = 4.0;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_OPTION_WITHIN(sigma_m, 1e-9, 1000.0);
    PLUMBLINE_CHECK_OPTION(robust_gate_sigmas, >=, 0.1);
    return true;
  }
};

/// A step of the odometry that is known to be worse than the others: the robot was carried, or
/// slid.
struct DownweightedStep {
  std::size_t step = 0;       ///< index into SlamGraph::odometry(); beyond it: no step
  double sigma_factor = 1.0;  ///< all its standard deviations are this times the model's

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_FINITE_OPTION(sigma_factor, >, 0.0);
    return true;
  }
};

/// What a relative pose that is ignored still says keeps the graph in one piece, and no more.
constexpr double kIgnoredSigmaFactor = 1000.0;

/// All sigmas and gates of the energy.
struct FactorOptions {
  MotionOptions motion;      ///< odometry
  RangeBeamOptions beam;     ///< the laser
  ManifoldOptions manifold;  ///< surfaces are thin
  /// Whether adjacent surfaces are drawn to parallel or orthogonal. Off by default: in simulated
  /// buildings and on real logs it gains nothing beside the returns themselves, and bends walls
  /// that are not at right angles.
  bool shape = false;
  /// Where the motion model does not hold. Solve adds such steps by itself, see
  /// contradicted_steps.h.
  std::vector<DownweightedStep> downweighted_steps;
  /// Relative poses that are known to be wrong, by their indices in SlamGraph::relative_poses():
  /// their standard deviations are kIgnoredSigmaFactor times what they say. Solve adds those that
  /// the scans contradict, see contradicted_edges.h.
  std::vector<std::size_t> ignored_relative_poses;

  /// Geman-McClure scale of the shape terms, in standard deviations.
  double ShapeGateSigmas() const { return 0.75 * manifold.robust_gate_sigmas; }

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_NESTED_OPTIONS(motion);
    PLUMBLINE_CHECK_NESTED_OPTIONS(beam);
    PLUMBLINE_CHECK_NESTED_OPTIONS(manifold);
    for (const DownweightedStep& downweighted : downweighted_steps) {
      if (!downweighted.Check(error)) return false;
    }
    return true;
  }
};

}  // namespace plumbline

#endif  // PLUMBLINE_FACTORS_FACTOR_OPTIONS_H_
