#ifndef PLUMBLINE_SOLVERS_VERDICT_H_
#define PLUMBLINE_SOLVERS_VERDICT_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/pose_change.h"
#include "plumbline/solvers/reduced/surface_patches.h"

namespace plumbline {

/// Whether a state of the poses is better than the seed, by two yardsticks. Both are the mean of
/// two: under the patches that the seed's poses give and under those of the state's poses. Under
/// its own patches each state looks good, even one that is all wrong; both take that advantage.
///
/// Energy: of the returns that poses and lines were found with, and of the pose terms; see
/// PatchEnergies. Held-out error: mean of rho(d^2 / s^2), squared distance of a held-out return
/// from the line of its patch in its own variances, robust; the other returns put the line there.
/// Pose terms have no part in it: odometry that contradicts the scans lowers the energy and raises
/// this, and is refused. Relative poses are knowledge of their own, and obeying them may cost the
/// scans a little: with them the energy, which counts both, decides unless the map falls apart.
struct Verdict {
  double seed_energy = 0.0;
  double final_energy = 0.0;
  std::size_t num_held_out = 0;  ///< held-out returns on patches of either
  double seed_held_out_error = 0.0;
  double final_held_out_error = 0.0;
  /// Standard deviation that chance gives to the difference of these two: each return is one draw
  /// of it.
  double held_out_noise = 0.0;
  double energy_rounding = 0.0;  ///< what rounding may change of the energies
  bool with_relative_poses = false;
  /// Parts of the drive that fit clearly worse than in the seed, see local_acceptance.h.
  /// CompareWithSeed does not count them, CandidateJudge does.
  int num_worse_stretches = 0;

  bool LowersEnergy() const { return final_energy < seed_energy - energy_rounding; }
  /// Up to this the held-out error may rise: two standard deviations may be chance; with relative
  /// poses, to twice that of the seed if that is more.
  double LargestHeldOutError() const;
  bool KeepsHeldOutError() const { return final_held_out_error <= LargestHeldOutError(); }
  /// Both yardsticks speak for it, whatever single stretches say.
  bool IsBetterAsAWhole() const { return LowersEnergy() && KeepsHeldOutError(); }
  bool IsBetter() const { return IsBetterAsAWhole() && num_worse_stretches == 0; }
  /// The figures, and what speaks against the state.
  std::string Text() const;
};

/// Poses, (x, y, yaw) each, and the surfaces as they place them: as CutIntoPatches gives them with
/// hold_out.
struct JudgedState {
  const std::vector<double>& poses;
  const SurfacePatches& patches;
};

/// Compares a state with the seed. Returns without a normal have no say: which patch they are on
/// depends on the state, which they would speak for. The result does not depend on the number of
/// threads. changes: if given, what the held-out returns of each pose say.
Verdict CompareWithSeed(const SlamGraph& graph, const MeasuredSurface& surface,
                        const FactorOptions& factors, const JudgedState& seed,
                        const JudgedState& state, ThreadPool* pool,
                        std::vector<PoseChange>* changes = nullptr);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_VERDICT_H_
