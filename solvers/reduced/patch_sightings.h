#ifndef PLUMBLINE_SOLVERS_REDUCED_PATCH_SIGHTINGS_H_
#define PLUMBLINE_SOLVERS_REDUCED_PATCH_SIGHTINGS_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/reduced/surface_patches.h"

namespace plumbline {

/// One per pose, from (x, y, yaw) each.
std::vector<PoseFrame> FramesOf(const std::vector<double>& poses);

/// All that one pose saw of one patch. Returns z_i with weights w_i cost, whatever the pose (R, t)
/// and the line (n, offset) about `origin`,
///   1/2 sum_i w_i (n . (R z_i + t - origin) - offset)^2
///     = 1/2 [ weight (n . (R centroid + t - origin) - offset)^2 + (R^T n)^T scatter (R^T n) ],
/// exactly: six numbers stand for any number of returns.
struct PatchSighting {
  int pose = 0;
  int patch = 0;
  double weight = 0.0;                                 ///< sum of w_i [1/m^2]
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  ///< frame of the robot [m]
  double xx = 0.0, xy = 0.0, yy = 0.0;  ///< scatter about the centroid, sum of w_i z z^T

  Eigen::Vector2d ScatterTimes(const Eigen::Vector2d& v) const {
    return {xx * v.x() + xy * v.y(), xy * v.x() + yy * v.y()};
  }
};

/// The sightings of a map, in order of patches and within a patch of poses.
struct PatchSightings {
  std::vector<PatchSighting> sightings;
  std::vector<std::size_t> first_of_patch;  ///< per patch, and the end
  std::vector<int> of_pose;                 ///< indices of sightings, grouped by pose
  std::vector<std::size_t> first_of_pose;   ///< into of_pose: per pose, and the end

  std::size_t num_patches() const { return first_of_patch.size() - 1; }
  std::size_t num_poses() const { return first_of_pose.size() - 1; }
};

/// How the returns of one sighting answer to a change of all ranges: with the distance d of each
/// from its patch's line, its weight w, and the slope g = dd / drange, the cosine of incidence.
struct RangeSlope {
  double weight = 0.0;                               ///< sum of w g [1/m^2]
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();  ///< sum of w g z [1/m], frame of the robot
  double curvature = 0.0;                            ///< sum of w g^2 [1/m^2]
  double gradient = 0.0;                             ///< sum of w g d [1/m]
};

/// Turns millions of returns into sightings, again and again as the weights follow the residuals.
class ReturnCompressor {
 public:
  /// Keeps references to the graph and the surface.
  ReturnCompressor(const SlamGraph& graph, const MeasuredSurface& surface,
                   const SurfaceNoise& noise, ThreadPool* pool);

  /// Lays out the sightings, all of weight zero. Takes patch_of_return over. The sightings that the
  /// other functions want are those of the last layout.
  PatchSightings LayOut(std::size_t num_patches, std::vector<int> patch_of_return);

  /// What LayOut took over.
  std::vector<int> PatchOfReturn() const;

  /// Sums up all returns with weights rho'(d^2 / s^2) / s^2: d the distance from the patch's line,
  /// s^2 = sigma_M^2 + n^T C n, C the covariance of the beam. Gives the robust cost of the returns,
  /// 1/2 sum rho(d^2 / s^2), at the lines and poses given.
  double Weigh(const std::vector<SurfacePatch>& patches, const std::vector<PoseFrame>& frames,
               const GemanMcClure& loss, PatchSightings* sightings) const;

  /// The robust cost that Weigh gives, and nothing else.
  double Cost(const std::vector<SurfacePatch>& patches, const std::vector<PoseFrame>& frames,
              const GemanMcClure& loss, const PatchSightings& sightings) const;

  /// One per sighting, with the weights that Weigh gives to the same lines and poses.
  std::vector<RangeSlope> RangeSlopes(const std::vector<SurfacePatch>& patches,
                                      const std::vector<PoseFrame>& frames,
                                      const GemanMcClure& loss,
                                      const PatchSightings& sightings) const;

 private:
  // Neighbouring returns of a scan on the same patch are a run. Calls body(entry, for_each) for
  // every run of a pose, where for_each(take) calls take with each return of it. entry: into
  // of_pose of the sightings, from the pose's first one.
  template <typename Body>
  void ForEachRun(std::size_t pose, const std::vector<SurfacePatch>& patches,
                  const PoseFrame& frame, const PatchSightings& sightings, const Body& body) const;
  template <typename Body>
  void ForEachReturnOnPatch(std::size_t pose, const Body& body);
  // The sum of cost_of_pose(pose), in the same order for any number of threads.
  template <typename Body>
  double SumOverPoses(const Body& cost_of_pose) const;
  // The patches that each pose sees, ascending, in one list per chunk of poses.
  std::vector<std::vector<int>> ListPatches(std::vector<std::size_t>* first_of_pose);
  // Turns the patch of every return into its entry.
  void NameEntries(const std::vector<std::vector<int>>& patches_of_chunk,
                   const PatchSightings& sightings);

  const SlamGraph& graph_;
  const MeasuredSurface& surface_;
  const SurfaceNoise noise_;
  ThreadPool* pool_;
  std::vector<int> scans_of_pose_;  // grouped by pose
  std::vector<std::size_t> first_scan_of_pose_;
  std::vector<int> entry_of_return_;  // its patch, until the sightings are laid out
  std::vector<int> patch_of_entry_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_REDUCED_PATCH_SIGHTINGS_H_
