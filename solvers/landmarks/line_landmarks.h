#ifndef PLUMBLINE_SOLVERS_LANDMARKS_LINE_LANDMARKS_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_LINE_LANDMARKS_H_

#include <Eigen/Core>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/scan_returns.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/association/surface_cells.h"
#include "plumbline/solvers/association/tangent_lines.h"
#include "plumbline/solvers/interface/association_options.h"
#include "plumbline/solvers/landmarks/shared_landmarks.h"

namespace plumbline {

/// A piece of surface that one tangent line serves: all points p of the world with
/// normal . (p - origin) = offset_m.
struct LineLandmark {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();   ///< near the landmark, world [m]; fixed
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< unit, world
  double offset_m = 0.0;

  /// Of a point of the world from the line [m], positive where the normal points to.
  double Distance(const Eigen::Vector2d& point) const {
    return normal.dot(point - origin) - offset_m;
  }
};

struct LineLandmarks {
  static constexpr int kNone = -1;

  std::vector<LineLandmark> landmarks;
  std::vector<int> landmark_of_return;  ///< kNone: not on a line-like surface
  SharedLandmarks shared;               ///< those that peers of the graph have as well
};

/// The end of a beam in the world.
struct PlacedBeam {
  Eigen::Vector2d end;        ///< [m]
  Eigen::Vector2d direction;  ///< unit, from the laser
  double range_m;

  /// Of a return as a robot sees it.
  PlacedBeam(const ScanReturns& returns, std::size_t return_id, const PoseFrame& frame)
      : end(frame * returns.PointInRobot(return_id)),
        direction(frame.Rotate(returns.DirectionInRobot(return_id))),
        range_m(returns.Range(return_id)) {}
};

struct LineLandmarkOptions {
  double largest_m = 0.8;  ///< side of the largest cell; the smallest is an eighth of it
  /// Of a return off its surface.
  SurfaceNoise noise;
  /// Held-out returns have no say in the landmarks. They get the one of their cell, if it has one.
  bool hold_out = false;
  /// Returns without a normal join landmarks. False where only those with one are asked for.
  bool joins_without_normal = true;

  /// How far a return without a normal is off a line, in sigmas and squared; infinitely far if the
  /// line does not face the laser.
  double SquaredSigmasOff(const LineLandmark& line, const PlacedBeam& beam) const;
};

/// The landmarks that suit the noise. One pose is enough for a landmark, which then says nothing of
/// where that pose is, but where a surface runs that nothing else has seen.
LineLandmarkOptions LandmarkOptionsFor(const FactorOptions& factors,
                                       const AssociationOptions& association);

/// The axes of the landmarks' cells, for walls that mostly run along or across a direction, see
/// DominantDirection. largest_m: side of the largest cells.
SurfaceGrid LandmarkGrid(double dominant_direction_rad, double largest_m);

/// Cuts the surfaces that the scans saw, placed by the poses, (x, y, yaw) each, into landmarks:
/// cells of a quadtree per octant of the normals' direction. A cell stays whole unless the lines of
/// its quarters explain its returns better than its own, by more than they owe to their number. So
/// the size follows the data: sparse and noisy returns share long lines, dense ones resolve a
/// curve. Returns without a normal have no say in that, and then join the line that faces their
/// laser and is fewest standard deviations off, at most three, if the options let them. Bitwise the
/// same for any number of threads. Collective for a shared graph: returns of all processes make the
/// landmarks.
LineLandmarks CutIntoLandmarks(const SlamGraph& graph, const std::vector<double>& poses,
                               const MeasuredSurface& surface, const LineLandmarkOptions& options,
                               ThreadPool* pool);

/// Gives every return without a line of its own (too far from others, or seen at a grazing angle)
/// that of its landmark, if it lies on one. lines: per return.
void AddLandmarkLines(const LineLandmarks& landmarks, ThreadPool* pool, TangentLines* lines);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_LINE_LANDMARKS_H_
