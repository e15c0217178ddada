#ifndef PLUMBLINE_SOLVERS_VERDICT_H_
#define PLUMBLINE_SOLVERS_VERDICT_H_

#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/solvers/reduced/surface_patches.h"

namespace plumbline {

/// Whether a state of the poses is better than the seed, by two yardsticks that both use the seed's
/// patches. Energy: of the returns that poses and lines were found with, and of the pose terms; see
/// PatchEnergies. Held-out error: mean of rho(d^2 / s^2), squared distance of a held-out return
/// from the line of its patch in its own variances, robust; the other returns put the line there.
/// Pose terms have no part in it: constraints that contradict the scans lower the energy and raise
/// this.
struct Verdict {
  double seed_energy = 0.0;
  double final_energy = 0.0;
  std::size_t num_held_out = 0;  ///< held-out returns on patches
  double seed_held_out_error = 0.0;
  double final_held_out_error = 0.0;
  /// Standard deviation that chance gives to the difference of these two: each return is one draw
  /// of it.
  double held_out_noise = 0.0;
  double energy_rounding = 0.0;  ///< what rounding may change of the energies

  bool LowersEnergy() const { return final_energy < seed_energy - energy_rounding; }
  /// Up to two standard deviations, a rise may be chance.
  bool LowersHeldOutError() const {
    return num_held_out == 0 || final_held_out_error < seed_held_out_error + 2.0 * held_out_noise;
  }
  bool IsBetter() const { return LowersEnergy() && LowersHeldOutError(); }
  /// The figures, and what speaks against the state.
  std::string Text() const;
};

/// Compares poses, (x, y, yaw) each, with those of the seed. seed_patches: as CutIntoPatches gives
/// them with hold_out at the seed's poses; a return without a normal must have been taken off,
/// since where it went depends on the seed, which it would speak for. The result does not depend on
/// the number of threads.
Verdict CompareWithSeed(const SlamGraph& graph, const MeasuredSurface& surface,
                        const FactorOptions& factors, const SurfacePatches& seed_patches,
                        const std::vector<double>& seed, const std::vector<double>& poses,
                        ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_VERDICT_H_
