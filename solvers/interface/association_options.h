#ifndef PLUMBLINE_SOLVERS_INTERFACE_ASSOCIATION_OPTIONS_H_
#define PLUMBLINE_SOLVERS_INTERFACE_ASSOCIATION_OPTIONS_H_

#include <string>

namespace plumbline {

/// How the neighbourhood is chosen that a point's tangent line is fitted to.
enum class NeighborhoodType {
  kRadius,   ///< all points within a radius, which grows where the map is sparse
  kNearest,  ///< the published form: 10 to 50 nearest points, their number by density
};
const char* ToString(NeighborhoodType type);
bool FromString(const std::string& name, NeighborhoodType* type);

/// Which returns share a surface.
struct AssociationOptions {
  NeighborhoodType neighborhood = NeighborhoodType::kRadius;  ///< of the solvers over points
  /// Fewest points that make a tangent line; a radius grows until it holds as many. From 3 to 1000:
  /// the work grows with it.
  int min_points = 10;
  /// A line of single points needs those of more than one pose: the points of one tie it to nothing
  /// but its own noise.
  bool several_poses = true;
  /// Reduced solver only: side [m] of the largest cell that may be one landmark, or 32 standard
  /// deviations of a return off its surface if that is more; cells are split down to an eighth.
  /// From a millimetre to 100 m, less and more than any wall.
  double landmark_size_m = 0.8;
  /// kNearest only: most points of a neighbourhood; up to 1000, see min_points.
  int max_points = 50;
  /// A neighbourhood counts as line-like up to this ratio of its smaller to its larger variance;
  /// from 1e-6, a thousandth as thick as long, to 1.
  double max_eigenvalue_ratio = 0.15;
  /// Shape pairs: length [m] of the surface regions along a scan. Normals over less are noise. From
  /// a millimetre to 100 m.
  double min_segment_length_m = 0.2;
  /// Shape pairs: regions pair up if they are this close [rad] to parallel or orthogonal; less
  /// than pi / 4, where all pairs are.
  double shape_margin_rad = 0.17453292519943295;  // 10 degrees

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_ASSOCIATION_OPTIONS_H_
