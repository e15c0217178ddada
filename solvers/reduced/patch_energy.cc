#include "plumbline/solvers/reduced/patch_energy.h"

#include <utility>

#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/pose_terms.h"
#include "plumbline/solvers/reduced/patch_sightings.h"
#include "plumbline/solvers/reduced/pose_system.h"

namespace plumbline {

std::vector<double> PatchEnergies(const SlamGraph& graph, const MeasuredSurface& surface,
                                  const FactorOptions& factors, SurfacePatches cut,
                                  const std::vector<const std::vector<double>*>& states,
                                  ThreadPool* pool) {
  ReturnCompressor compressor(graph, surface, NoiseOf(factors), pool);
  PatchSightings sightings = compressor.LayOut(cut.patches.size(), std::move(cut.patch_of_return));
  const GemanMcClure loss = GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas);
  const PoseTerms terms(graph, factors);
  std::vector<double> energies;
  for (const std::vector<double>* poses : states) {
    const std::vector<PoseFrame> frames = FramesOf(*poses);
    std::vector<SurfacePatch> patches = cut.patches;
    // The lines at hand may be those of other poses: all returns pull at first, and then those near
    // the lines.
    for (const double gate_sigmas : {1e3, factors.manifold.robust_gate_sigmas}) {
      compressor.Weigh(patches, frames, GemanMcClure::FromGate(gate_sigmas), &sightings);
      FitPatchLines(sightings, frames, pool, &patches);
    }
    energies.push_back(compressor.Weigh(patches, frames, loss, &sightings) + terms.Cost(*poses));
  }
  return energies;
}

}  // namespace plumbline
