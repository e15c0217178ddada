#ifndef PLUMBLINE_SOLVERS_LANDMARKS_LINE_OBSERVATIONS_H_
#define PLUMBLINE_SOLVERS_LANDMARKS_LINE_OBSERVATIONS_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "plumbline/core/line_fit.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/factors/robust_loss.h"
#include "plumbline/factors/surface_noise.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/shared_landmarks.h"

namespace plumbline {

/// One per pose, from (x, y, yaw) each.
std::vector<PoseFrame> FramesOf(const std::vector<double>& poses);

/// All that one pose saw of one landmark. Returns z_i with weights w_i cost, whatever the pose (R,
/// t) and the line (n, offset) about `origin`,
///   1/2 sum_i w_i (n . (R z_i + t - origin) - offset)^2
///     = 1/2 [ weight (n . (R centroid + t - origin) - offset)^2 + (R^T n)^T scatter (R^T n) ]:
/// six numbers stand for any number of returns, in single precision like what they sum up.
struct LineObservation {
  int pose = 0;
  int landmark = 0;
  float weight = 0.0F;                               ///< sum of w_i [1/m^2]
  Eigen::Vector2f center = Eigen::Vector2f::Zero();  ///< centroid, frame of the robot [m]
  float xx = 0.0F, xy = 0.0F, yy = 0.0F;  ///< scatter about the centroid, sum of w_i z z^T

  Eigen::Vector2d centroid() const { return center.cast<double>(); }
  Eigen::Vector2d ScatterTimes(const Eigen::Vector2d& v) const {
    return {xx * v.x() + xy * v.y(), xy * v.x() + yy * v.y()};
  }
};

/// The observations of a map, in order of landmarks and within a landmark of poses.
struct LineObservations {
  std::vector<LineObservation> observations;
  std::vector<std::size_t> first_of_landmark;  ///< per landmark, and the end
  std::vector<int> of_pose;                    ///< indices of observations, by pose, ascending
  std::vector<std::size_t> first_of_pose;      ///< into of_pose: per pose, and the end
  SharedLandmarks shared;                      ///< landmarks that peers have observed as well

  std::size_t num_landmarks() const { return first_of_landmark.size() - 1; }
  std::size_t num_poses() const { return first_of_pose.size() - 1; }
};

/// How the returns of one observation answer to a change of all ranges: with the distance d of each
/// from its landmark's line, its weight w, and the slope g = dd / drange, the cosine of incidence.
struct RangeSlope {
  double weight = 0.0;                               ///< sum of w g [1/m^2]
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();  ///< sum of w g z [1/m], frame of the robot
  double curvature = 0.0;                            ///< sum of w g^2 [1/m^2]
  double gradient = 0.0;                             ///< sum of w g d [1/m]
};

/// Which of the returns on landmarks are compressed.
struct ReturnSelection {
  bool without_held_out = false;  ///< not those of HeldOutReturns
  /// Only those that have a normal here; null: whether they have one or not.
  const MeasuredSurface* surface = nullptr;
};

struct LineInRobot;

/// Turns millions of returns into observations, again and again as the weights follow the
/// residuals.
class ReturnCompressor {
 public:
  /// Keeps a reference to the graph.
  ReturnCompressor(const SlamGraph& graph, const SurfaceNoise& noise, ThreadPool* pool);
  ReturnCompressor(const ReturnCompressor&) = delete;
  ReturnCompressor& operator=(const ReturnCompressor&) = delete;

  /// Lays out the observations, all of weight zero. The observations that the other functions want
  /// are those of the last layout. landmark_of_return: as in LineLandmarks. shared: of the
  /// landmarks.
  LineObservations LayOut(std::size_t num_landmarks, const std::vector<int>& landmark_of_return,
                          SharedLandmarks shared = {}, const ReturnSelection& selection = {});
  /// Frees what the layout takes. Another one has to come before the other functions.
  void ForgetLayout();

  /// Sums up all returns, each with weight one.
  void WeighEqually(LineObservations* observations) const;

  /// Sums up all returns with weights rho'(d^2 / s^2) / s^2: d the distance from the landmark's
  /// line, s^2 = sigma_M^2 + n^T C n, C the covariance of the beam. Gives the robust cost of the
  /// returns, 1/2 sum rho(d^2 / s^2), at the lines and poses given; those of this process, if the
  /// graph is shared.
  double Weigh(const std::vector<LineLandmark>& landmarks, const std::vector<PoseFrame>& frames,
               const GemanMcClure& loss, LineObservations* observations) const;

  /// The robust cost that Weigh gives, and nothing else.
  double Cost(const std::vector<LineLandmark>& landmarks, const std::vector<PoseFrame>& frames,
              const GemanMcClure& loss) const;

  /// One per observation, with the weights that Weigh gives to the same lines and poses.
  std::vector<RangeSlope> RangeSlopes(const std::vector<LineLandmark>& landmarks,
                                      const std::vector<PoseFrame>& frames,
                                      const GemanMcClure& loss,
                                      const LineObservations& observations) const;

 private:
  // Neighbouring returns of a scan on the same landmark.
  struct Run {
    int first, end;  // counted from the scan's first return
    int entry;       // into of_pose of the observations, from the pose's first one
  };
  // Calls body(run) for every run of a scan, with its landmark in place of the entry.
  template <typename Body>
  void FindRuns(int scan_id, const std::vector<int>& landmark_of_return,
                const ReturnSelection& selection, const Body& body) const;
  void ListRuns(const std::vector<int>& landmark_of_return, const ReturnSelection& selection);
  // Turns the landmarks of the runs into entries.
  void NumberEntries(std::size_t num_landmarks);
  std::size_t NumEntries(std::size_t pose) const {
    return first_entry_[pose + 1] - first_entry_[pose];
  }
  // What the work on one pose takes, by its entries; used again for the next pose.
  struct Scratch {
    std::vector<LineInRobot> lines;
    std::vector<PointMoments> moments;
  };
  // The sum of cost_of_pose(pose, scratch), in the same order for any number of threads.
  template <typename Body>
  double SumOverPoses(const Body& cost_of_pose) const;
  // The runs of one scan, in its chunk's array.
  struct RunsOfScan {
    Run* first = nullptr;
    Run* last = nullptr;  // behind the last one

    Run* begin() const { return first; }
    Run* end() const { return last; }
  };
  // Calls body(scan id, its runs) for every scan of a pose.
  template <typename Body>
  void ForEachScanOf(std::size_t pose, const Body& body) const;
  // Calls body(scan id, its returns, run) for every run of a pose.
  template <typename Body>
  void ForEachRun(std::size_t pose, const Body& body) const;
  // Calls body(entry, for_each) for every run of a pose, where for_each(take) calls take with the
  // ReturnResidual of each return of it.
  template <typename Body>
  void ForEachResidual(std::size_t pose, const std::vector<LineLandmark>& landmarks,
                       const PoseFrame& frame, Scratch* scratch, const Body& body) const;
  // moments: of the entries of a pose, about the origin of the robot.
  void SetObservations(std::size_t pose, const std::vector<PointMoments>& moments,
                       LineObservations* observations) const;

  const SlamGraph& graph_;
  const SurfaceNoise noise_;
  ThreadPool* pool_;
  std::vector<int> scans_of_pose_;  // grouped by pose
  std::vector<std::size_t> first_scan_of_pose_;
  // Scan by scan, in the order of scans_of_pose_: one array per chunk of scans, as one of all would
  // lie beside them while it is put together.
  std::vector<std::vector<Run>> runs_of_chunk_;
  std::vector<RunsOfScan> runs_of_scan_;
  std::vector<int> landmark_of_entry_;
  std::vector<std::size_t> first_entry_;  // per pose, and the end
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_LANDMARKS_LINE_OBSERVATIONS_H_
