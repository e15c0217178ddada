#ifndef PLUMBLINE_SOLVERS_ASSOCIATION_ASSOCIATIONS_H_
#define PLUMBLINE_SOLVERS_ASSOCIATION_ASSOCIATIONS_H_

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/manifold_factor.h"
#include "plumbline/factors/shape_factor.h"

namespace plumbline {

/// How the neighbourhood is chosen that a point's tangent line is fitted to.
enum class NeighborhoodType {
  kRadius,   ///< all points within a radius, which grows where the map is sparse
  kNearest,  ///< the published form: 10 to 50 nearest points, their number by density
};
const char* ToString(NeighborhoodType type);
bool FromString(const std::string& name, NeighborhoodType* type);

/// Largest angle [rad] between normals of one surface, 60 degrees: kNearest takes no neighbour
/// beyond it, so that the two faces of a wall and the two sides of a corner stay apart, and the
/// surface regions of the shape pairs end there. kRadius keeps faces and sides apart by octants of
/// the normals' directions instead: it takes those of a point's own octant and of the two next to
/// it.
constexpr double kMaxNormalAngleRad = 1.0471975511965976;

struct AssociationOptions {
  NeighborhoodType neighborhood = NeighborhoodType::kRadius;
  /// Fewest points that make a tangent line; a radius grows until it holds as many.
  int min_points = 10;
  /// A line of single points needs those of more than one pose: the points of one tie it to nothing
  /// but its own noise.
  bool several_poses = true;
  /// Reduced solver only: side [m] of the largest cell that may be one patch, or 32 standard
  /// deviations of a return off its surface if that is more; cells are split down to an eighth.
  double patch_size_m = 0.8;
  /// kNearest only: most points of a neighbourhood.
  int max_points = 50;
  /// A neighbourhood counts as line-like up to this ratio of its smaller to its larger variance.
  double max_eigenvalue_ratio = 0.15;
  /// Shape pairs: length [m] of the surface regions along a scan. Normals over less are noise.
  double min_segment_length_m = 0.2;
  /// Shape pairs: regions pair up if they are this close [rad] to parallel or orthogonal.
  double shape_margin_rad = 0.17453292519943295;  // 10 degrees

  bool Check(std::string* error) const;
};

/// One shape term: the segment from point `previous` to point `current` of one surface against the
/// fixed normal of an adjacent region.
struct ShapePair {
  std::size_t previous = 0;                                   ///< return id
  std::size_t current = 0;                                    ///< return id
  Eigen::Vector2d adjacent_normal = Eigen::Vector2d::Zero();  ///< unit, world frame
  ShapeCategory category = ShapeCategory::k0;
};

/// What the map prior is made of: rebuilt from the current map in the outer loop, fixed inside.
struct Associations {
  /// Per return; the zero normal marks a point that no tangent line draws.
  std::vector<TangentLine> lines;
  std::vector<ShapePair> shape_pairs;

  static bool HasLine(const TangentLine& line) {
    return line.normal_x != 0.0 || line.normal_y != 0.0;
  }
  std::size_t CountLines() const;
};

/// Builds the associations of a state of the graph.
/// radius_m: smallest neighbourhood of kRadius.
Associations BuildAssociations(const SlamGraph& graph, const MapState& state,
                               const MeasuredSurface& surface, const AssociationOptions& options,
                               double radius_m, ThreadPool* pool);

/// The parts of BuildAssociations. LinesFromRadius is fitted to the measured ends of the beams,
/// placed by the poses, (x, y, yaw) each; the other two see the state's points, (x, y) each.
std::vector<TangentLine> LinesFromRadius(const SlamGraph& graph, const std::vector<double>& poses,
                                         const MeasuredSurface& surface,
                                         const AssociationOptions& options, double radius_m,
                                         ThreadPool* pool);
std::vector<TangentLine> LinesFromNearest(const SlamGraph& graph, const MapState& state,
                                          const std::vector<Eigen::Vector2f>& normals,
                                          const AssociationOptions& options, ThreadPool* pool);
std::vector<ShapePair> FindShapePairs(const SlamGraph& graph, const std::vector<double>& points,
                                      const std::vector<Eigen::Vector2f>& normals,
                                      const std::vector<TangentLine>& lines,
                                      const AssociationOptions& options, ThreadPool* pool);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ASSOCIATION_ASSOCIATIONS_H_
