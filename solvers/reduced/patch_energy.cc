#include "plumbline/solvers/reduced/patch_energy.h"

#include <utility>

#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/pose_terms.h"
#include "plumbline/solvers/reduced/patch_sightings.h"
#include "plumbline/solvers/reduced/pose_system.h"

namespace plumbline {

void SettleLines(const ReturnCompressor& compressor, const std::vector<PoseFrame>& frames,
                 double gate_sigmas, ThreadPool* pool, PatchSightings* sightings,
                 std::vector<SurfacePatch>* patches) {
  // The lines at hand may be those of other poses: all returns pull at first, and then those near
  // the lines.
  for (const double gate : {1e3, gate_sigmas}) {
    compressor.Weigh(*patches, frames, GemanMcClure::FromGate(gate), sightings);
    FitPatchLines(*sightings, frames, pool, patches);
  }
}

std::vector<double> PatchEnergies(const SlamGraph& graph, const MeasuredSurface& surface,
                                  const FactorOptions& factors, SurfacePatches cut,
                                  const std::vector<const std::vector<double>*>& states,
                                  ThreadPool* pool, std::vector<std::vector<SurfacePatch>>* lines) {
  ReturnCompressor compressor(graph, surface, NoiseOf(factors), pool);
  PatchSightings sightings = compressor.LayOut(cut.patches.size(), std::move(cut.patch_of_return));
  const PoseTerms terms(graph, factors);
  const double gate_sigmas = factors.manifold.robust_gate_sigmas;
  std::vector<double> energies;
  for (const std::vector<double>* poses : states) {
    const std::vector<PoseFrame> frames = FramesOf(*poses);
    std::vector<SurfacePatch> patches = cut.patches;
    SettleLines(compressor, frames, gate_sigmas, pool, &sightings, &patches);
    const GemanMcClure loss = GemanMcClure::FromGate(gate_sigmas);
    energies.push_back(compressor.Cost(patches, frames, loss, sightings) + terms.Cost(*poses));
    if (lines != nullptr) lines->push_back(std::move(patches));
  }
  return energies;
}

}  // namespace plumbline
