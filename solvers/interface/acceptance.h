#ifndef PLUMBLINE_SOLVERS_INTERFACE_ACCEPTANCE_H_
#define PLUMBLINE_SOLVERS_INTERFACE_ACCEPTANCE_H_

#include <cstddef>
#include <string>

namespace plumbline {

/// Whether a state of the poses is better than the seed, by two yardsticks. Both are the mean of
/// two: under the landmarks that the seed's poses give and under those of the state's poses. Under
/// its own landmarks each state looks good, even one that is all wrong; both take that advantage.
///
/// Energy: of the returns that poses and lines were found with, and of the pose terms; see
/// LandmarkEnergies. Held-out error: mean of rho(d^2 / s^2), squared distance of a held-out return
/// from the line of its landmark in its own variances, robust; the other returns put the line
/// there. Pose terms have no part in it: odometry that contradicts the scans lowers the energy and
/// raises this, and is refused. Relative poses and custom factors are knowledge of their own, and
/// obeying them may cost the scans a little: with them the energy, which counts both, decides
/// unless the map falls apart.
struct AcceptanceTest {
  double seed_energy = 0.0;           ///< of the seed
  double final_energy = 0.0;          ///< of the result
  std::size_t num_held_out = 0;       ///< held-out returns on landmarks of either
  double seed_held_out_error = 0.0;   ///< of the seed [sigmas^2]
  double final_held_out_error = 0.0;  ///< of the result [sigmas^2]
  /// Standard deviation that chance gives to the difference of these two: each return is one draw
  /// of it.
  double held_out_noise = 0.0;
  double energy_rounding = 0.0;  ///< what rounding may change of the energies
  /// Rounding as a share: measured points have single precision.
  static constexpr double kRounding = 1e-9;
  bool with_other_constraints = false;  ///< relative poses, or custom factors
  /// Parts of the drive that fit clearly worse than in the seed, see acceptance/candidate.h.
  /// CompareWithSeed does not count them, CandidateEvaluator does.
  int num_worse_stretches = 0;

  /// By more than rounding may.
  bool LowersEnergy() const { return final_energy < seed_energy - energy_rounding; }
  /// Up to this the held-out error may rise: two standard deviations may be chance; with relative
  /// poses, to twice that of the seed if that is more.
  double LargestHeldOutError() const;
  /// Up to LargestHeldOutError.
  bool KeepsHeldOutError() const { return final_held_out_error <= LargestHeldOutError(); }
  /// Both yardsticks speak for it, whatever single stretches say.
  bool IsBetterAsAWhole() const { return LowersEnergy() && KeepsHeldOutError(); }
  /// That, and no stretch of the drive fits clearly worse.
  bool IsBetter() const { return IsBetterAsAWhole() && num_worse_stretches == 0; }
  /// The figures, and what speaks against the state.
  std::string Text() const;
};

/// Consecutive poses that a state places clearly worse than the seed does, by ids.
struct WorseStretch {
  int first = 0;             ///< the first one in it
  int last = 0;              ///< the last one in it
  double seed_error = 0.0;   ///< mean held-out error at the seed [sigmas^2]
  double state_error = 0.0;  ///< mean held-out error of the state [sigmas^2]
};

/// A relative pose that the scans contradict, and how far the result is off it.
struct IgnoredEdge {
  std::size_t edge = 0;  ///< index into SlamGraph::relative_poses()
  long long from = 0;    ///< pose id; in reports on a file, its name there
  long long to = 0;      ///< likewise
  double off_m = 0.0;    ///< [m]
  double off_rad = 0.0;  ///< [rad]
  double sigmas = 0.0;   ///< the same in its own standard deviations
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_ACCEPTANCE_H_
