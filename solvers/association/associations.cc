#include "plumbline/solvers/association/associations.h"

namespace plumbline {

Associations BuildAssociations(const SlamGraph& graph, const MapState& state,
                               const MeasuredSurface& surface, const AssociationOptions& options,
                               double radius_m, ThreadPool* pool) {
  Associations associations;
  associations.lines = LinesFromRadius(graph, state.poses, surface, options, radius_m, pool);
  associations.shape_pairs = FindShapePairs(graph, state.points, surface.normals, pool);
  return associations;
}

}  // namespace plumbline
