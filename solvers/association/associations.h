#ifndef PLUMBLINE_SOLVERS_ASSOCIATION_ASSOCIATIONS_H_
#define PLUMBLINE_SOLVERS_ASSOCIATION_ASSOCIATIONS_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/return_normal.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/shape_factor.h"
#include "plumbline/solvers/association/tangent_lines.h"
#include "plumbline/solvers/interface/association_options.h"

namespace plumbline {

/// Largest angle [rad] between normals of one surface, 60 degrees: kNearest takes no neighbour
/// beyond it, so that the two faces of a wall and the two sides of a corner stay apart, and the
/// surface regions of the shape pairs end there. kRadius keeps faces and sides apart by octants of
/// the normals' directions instead: it takes those of a point's own octant and of the two next to
/// it.
constexpr double kMaxNormalAngleRad = 1.0471975511965976;

/// One shape term: a segment of one surface, between two of its points, against a segment of an
/// adjacent region.
struct ShapePair {
  std::size_t previous = 0;                    ///< return id
  std::size_t current = 0;                     ///< return id
  std::size_t adjacent_previous = 0;           ///< return id
  std::size_t adjacent_current = 0;            ///< return id
  ShapeCategory category = ShapeCategory::k0;  ///< parallel or orthogonal, and which way
};

/// What the map prior is made of: rebuilt from the current map in the outer loop, fixed inside.
struct Associations {
  TangentLines lines;                  ///< per return
  std::vector<ShapePair> shape_pairs;  ///< in order of scans
};

/// Builds the associations of a state of the graph.
/// radius_m: smallest neighbourhood of kRadius.
Associations BuildAssociations(const SlamGraph& graph, const MapState& state,
                               const MeasuredSurface& surface, const AssociationOptions& options,
                               double radius_m, ThreadPool* pool);

/// The parts of BuildAssociations. LinesFromRadius is fitted to the measured ends of the beams,
/// placed by the poses, (x, y, yaw) each; the other two see the state's points, (x, y) each.
/// Without normals (empty) LinesFromNearest has a line for every point, and no face of a wall or
/// side of a corner stays apart. hold_out: held-out returns (HeldOutReturns) get the lines of the
/// others, and are neighbours of none.
TangentLines LinesFromRadius(const SlamGraph& graph, const std::vector<double>& poses,
                             const MeasuredSurface& surface, const AssociationOptions& options,
                             double radius_m, ThreadPool* pool);
TangentLines LinesFromNearest(const SlamGraph& graph, const MapState& state,
                              const std::vector<ReturnNormal>& normals,
                              const AssociationOptions& options, ThreadPool* pool,
                              bool hold_out = false);
std::vector<ShapePair> FindShapePairs(const SlamGraph& graph, const std::vector<double>& points,
                                      const std::vector<ReturnNormal>& normals,
                                      const AssociationOptions& options, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ASSOCIATION_ASSOCIATIONS_H_
