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

/// Builds the associations of a state of the graph, with lines from this radius [m].
Associations BuildAssociations(const SlamGraph& graph, const MapState& state,
                               const MeasuredSurface& surface, const AssociationOptions& options,
                               double radius_m, ThreadPool* pool);

/// Lines of all points within a radius [m], which grows where the map is sparse. They are fitted to
/// the measured ends of the beams, placed by the poses, (x, y, yaw) each. Octants of the normals'
/// directions keep the two faces of a wall and the two sides of a corner apart.
TangentLines LinesFromRadius(const SlamGraph& graph, const std::vector<double>& poses,
                             const MeasuredSurface& surface, const AssociationOptions& options,
                             double radius_m, ThreadPool* pool);

/// Lines of the 10 to 50 points nearest to each point (x, y) of the map, as published. Every point
/// has one, and faces and sides do not stay apart. Held-out returns (HeldOutReturns) get the lines
/// of the others, and are neighbours of none.
TangentLines LinesFromNearest(const SlamGraph& graph, const std::vector<double>& points,
                              ThreadPool* pool);

/// Adjacent surface regions of a scan that are nearly parallel or orthogonal where the points,
/// (x, y) each, lie.
std::vector<ShapePair> FindShapePairs(const SlamGraph& graph, const std::vector<double>& points,
                                      const std::vector<ReturnNormal>& normals, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ASSOCIATION_ASSOCIATIONS_H_
