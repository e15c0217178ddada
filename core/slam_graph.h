#ifndef PLUMBLINE_CORE_SLAM_GRAPH_H_
#define PLUMBLINE_CORE_SLAM_GRAPH_H_

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "plumbline/core/custom_factor.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/measurements.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/scan_returns.h"
#include "plumbline/core/status.h"

namespace plumbline {

class Peers;

/// The measurements of one mapping problem: laser returns, odometry and relative poses between
/// robot poses, and an initial guess of every pose. Ids count up from 0 in order of addition.
///
/// The unknowns, poses and one map point per return, are a MapState. Solvers change that and never
/// the graph. They hold fixed poses where they were fixed. If no pose was fixed, custom factors
/// hold the map in the world, as positions by GPS do; without such factors the first pose is held.
class SlamGraph {
 public:
  /// The first measurement that was refused: InvalidArgument names it, its index and the error,
  /// as "scan 12: 179 ranges for a laser of 180 beams". That call and all later ones that add or
  /// fix change nothing and return -1; solvers refuse the graph with this message.
  const Status& status() const { return status_; }
  /// Returns status() and clears it: the graph is as before the refused measurement, and takes
  /// others again. For callers that report, or leave out, a bad measurement where they add it.
  Status TakeStatus();

  /// Returns the id of an equal laser that the graph already has, or else of a new one. Refuses a
  /// model that LaserModel::Check refuses.
  int AddLaser(const LaserModel& laser);

  /// Reserves memory for this number of returns in all, so that adding them takes no spare memory.
  void ReserveReturns(std::size_t num_returns);

  /// Adds a pose with its initial guess, and returns its id. Refuses a pose or time that is not
  /// finite, or beyond input_limits.h.
  int AddPose(const Pose2& initial_world_from_robot, double timestamp_s);

  /// Fixes a pose, anew if it was fixed before. Refuses an unknown id, and poses like AddPose.
  void FixPose(int pose_id, const Pose2& world_from_robot);
  /// Fixes a pose at its initial guess.
  void FixPose(int pose_id);

  /// Takes every return of the sweep as a map point, and returns the scan id. Refuses unknown ids,
  /// and ranges whose number is not the laser's number of beams.
  int AddScan(int pose_id, int laser_id, const std::vector<double>& ranges);

  /// Adds a sweep that took its time while the robot moved, with that motion taken out: its
  /// returns are as if seen from the pose, where the robot was when the first beam was measured.
  /// motion: from there to where it was a beam after the last, by odometry; in between it moves
  /// steadily. Returns the scan id. Refuses what AddScan refuses, a motion that AddOdometry
  /// refuses, and a laser with a beam_period_s: MapLog would take the motion out once more.
  int AddSweep(int pose_id, int laser_id, const std::vector<double>& ranges, const Pose2& motion,
               SweepOrder order = SweepOrder::kFirstBeamFirst);

  /// Takes points [m], in the frame of the robot, for the returns of a sweep: one whose motion has
  /// been taken out, or whose beams are not evenly spaced. They keep their range and bearing from
  /// the laser's mounting; the beams of its model say which of them are neighbours. Points that are
  /// not finite, or not within the laser's range, are no returns. Returns the scan id. Refuses
  /// unknown ids, and a point more than a step outside of the fan of beams, naming it.
  int AddPoints(int pose_id, int laser_id, const std::vector<Eigen::Vector2d>& points_in_robot);

  /// Copies a sweep of another graph with its laser, and returns the scan id. Refuses unknown ids.
  int AddScanOf(const SlamGraph& other, int scan_id, int pose_id);

  /// Refuses unknown or equal ids, and motions that are not finite or beyond input_limits.h.
  void AddOdometry(const OdometryConstraint& constraint);

  /// Refuses what AddOdometry refuses, and covariances that are not positive definite within
  /// limits.
  void AddRelativePose(const RelativePoseConstraint& constraint);

  /// Adds a measurement with a cost function of the host, see CustomFactor; points: return ids.
  /// Refuses unknown ids, parameter blocks other than the poses and points, and another number of
  /// residuals than the factors of the same name have.
  void AddFactor(const std::string& name, std::shared_ptr<const ceres::CostFunction> cost,
                 std::vector<int> poses, std::vector<std::size_t> points = {},
                 std::shared_ptr<ceres::LossFunction> loss = nullptr);

  /// Makes this graph a part of a larger one: it has all poses and constraints, but the scans of
  /// some poses only; the peers, not null, have the others. rank_of_pose: which peer has the scans
  /// of each pose; all_scans: the sweeps of the larger graph, with the sweeps of this part in its
  /// own order. Scan ids, return ids and the points of a state count within this part.
  void ShareWith(const Peers* peers, std::vector<int> rank_of_pose,
                 std::vector<ScanEntry> all_scans);
  const Peers* peers() const { return peers_; }  ///< who has the other scans; null: nobody
  /// As in ShareWith; empty if this graph has all scans.
  const std::vector<int>& rank_of_pose() const { return rank_of_pose_; }
  bool HasScansOf(int pose_id) const;  ///< whether they are in this graph, if it has any
  /// The sweeps of this graph and its peers.
  const std::vector<ScanEntry>& all_scans() const { return peers_ ? all_scans_ : scans_; }
  /// Which one of all_scans() a sweep of this graph is.
  int IdAmongAll(int scan_id) const { return peers_ ? id_among_all_[Index(scan_id)] : scan_id; }
  std::size_t num_returns_of_all() const;                     ///< of this graph and its peers
  std::size_t ReturnIdAmongAll(std::size_t return_id) const;  ///< which one of these it is

  /// Appends a sweep to bytes that AddPackedScan takes, in a process of the same program.
  void PackScan(int scan_id, std::vector<char>* bytes) const;
  /// Takes over a sweep of a graph with the same poses and lasers, bit by bit. Gives the place
  /// behind its bytes.
  const char* AddPackedScan(const char* bytes);

  /// Pose ids are 0 to num_poses() - 1, and so on for scans, lasers and returns.
  int num_poses() const { return static_cast<int>(timestamps_s_.size()); }
  int num_scans() const { return static_cast<int>(scans_.size()); }  ///< number of sweeps
  std::size_t num_returns() const { return returns_.size(); }  ///< of all scans, a map point each

  /// The initial guesses: x, y [m], yaw [rad] of world_from_robot, three numbers per pose.
  const std::vector<double>& initial_poses() const { return initial_poses_; }
  /// The initial guess of a pose. Needs a known id, as all accessors do.
  Pose2 InitialPose(int pose_id) const { return Pose2(&initial_poses_[3 * Index(pose_id)]); }
  /// The poses that FixPose named, in that order. If there are none: the first pose, or nothing
  /// where a custom factor holds the map in the world, in any direction.
  const std::vector<FixedPose>& fixed_poses() const {
    return fixed_poses_.empty() ? gauge_ : fixed_poses_;
  }
  bool has_named_fixed_poses() const { return !fixed_poses_.empty(); }             ///< by FixPose
  double timestamp_s(int pose_id) const { return timestamps_s_[Index(pose_id)]; }  ///< of a pose
  const std::vector<double>& timestamps_s() const { return timestamps_s_; }  ///< of all poses [s]

  const ScanEntry& scan(int scan_id) const { return scans_[Index(scan_id)]; }  ///< a sweep
  int num_lasers() const { return static_cast<int>(lasers_.size()); }  ///< of different ones
  /// The model of a laser, as AddLaser took it.
  const LaserModel& laser(int laser_id) const { return lasers_[Index(laser_id)].model; }
  /// The model of the laser that made a sweep.
  const LaserModel& LaserOfScan(int scan_id) const { return laser(scan(scan_id).laser); }
  /// Where the laser of a sweep stands, by these poses.
  Pose2 WorldFromLaser(int scan_id, const std::vector<double>& poses) const {
    return Pose2(&poses[3 * Index(scan(scan_id).pose)]) * LaserOfScan(scan_id).robot_from_laser;
  }

  /// The readings of a sweep as AddScan takes them, one range [m] per beam; no_return_m for beams
  /// without a return.
  std::vector<double> RangesOfScan(int scan_id, double no_return_m) const;

  const LaserReturns& returns() const { return returns_; }  ///< all readings, by return id
  /// All that is known of the returns of a sweep, the quick way.
  ScanReturns ReturnsOfScan(int scan_id) const {
    const ScanEntry& entry = scan(scan_id);
    const ScanIndex& index = scan_index_[Index(scan_id)];
    return {lasers_[Index(entry.laser)],
            returns_.range_m.data(),
            low_beam_.data(),
            entry.has_own_bearings ? off_beam_rad_.data() + index.first_own_bearing : nullptr,
            entry.first_return,
            index.first_large_beam};
  }
  int ScanOfReturn(std::size_t return_id) const;  ///< the sweep that it is part of
  /// Index of the beam of a return within its sweep; gaps are beams without return.
  int Beam(std::size_t return_id) const { return ReturnsNear(return_id).Beam(return_id); }
  /// Direction of a beam [rad] in the frame of its laser, counter-clockwise from the x axis.
  double Bearing(std::size_t return_id) const { return ReturnsNear(return_id).Bearing(return_id); }
  /// Whether it is of something that moves: no surface of the map. Corrected says so.
  bool Moves(std::size_t return_id) const { return return_id < moves_.size() && moves_[return_id]; }
  std::vector<int> ScansOfReturns() const;  ///< of all returns
  std::vector<int> Beams() const;           ///< of all returns
  std::vector<double> Bearings() const;     ///< of all returns
  /// Measured end of a beam [m] in the frame of its laser.
  Eigen::Vector2d PointInLaser(std::size_t id) const { return ReturnsNear(id).PointInLaser(id); }
  /// Measured end of a beam [m] in the frame of the robot.
  Eigen::Vector2d PointInRobot(std::size_t id) const { return ReturnsNear(id).PointInRobot(id); }

  const std::vector<OdometryConstraint>& odometry() const { return odometry_; }  ///< as added
  /// In the order of addition.
  const std::vector<RelativePoseConstraint>& relative_poses() const { return relative_poses_; }
  const std::vector<CustomFactor>& factors() const { return factors_; }  ///< as added

  /// Poses at their initial guesses, and the map points where the measurements put them from there.
  MapState InitialState() const;
  /// Adds to a state of this graph, or of one that it began as, what came after it, as InitialState
  /// has it, but seen from the state's poses.
  void ExtendState(MapState* state) const;
  /// Where the measurements put the map points, seen from poses as MapState has them: x, y [m] in
  /// the world, two numbers per return.
  std::vector<double> MeasuredMap(const std::vector<double>& poses) const;

  /// The same graph with other, finite measurements, in arrays that are empty or have the sizes
  /// that MeasurementCorrections names. A corrected return stays one: a range beyond what its laser
  /// takes for a return becomes the nearest that it does. Marks of what moves are only added.
  SlamGraph Corrected(const MeasurementCorrections& corrections) const&;
  /// The same for a graph that is of no more use.
  SlamGraph Corrected(const MeasurementCorrections& corrections) &&;

 private:
  struct Return;
  struct ScanIndex {                    // see ScanReturns
    std::size_t first_own_bearing = 0;  // in off_beam_rad_
    std::size_t first_large_beam = 0;   // return id
  };
  // Returns per entry of scan_of_block_, from which the search for a sweep begins.
  static constexpr std::size_t kReturnsPerBlock = 256;
  static std::size_t Index(int id) { return static_cast<std::size_t>(id); }
  bool HasPose(int id) const { return id >= 0 && id < num_poses(); }
  // These keep the error and return -1.
  int Refuse(const std::string& name, const std::string& problem);
  int RefuseScan(const std::string& problem);
  // These refuse the next scan if they return false.
  bool TakesScan(int pose_id, int laser_id);
  bool TakesRanges(int laser_id, const std::vector<double>& ranges);
  std::vector<Return> ReturnsOf(int laser_id, const std::vector<double>& ranges) const;
  // returns: in the order of their beams. Gives the scan id.
  int AppendScan(int pose_id, int laser_id, const std::vector<Return>& returns);
  ScanReturns ReturnsNear(std::size_t return_id) const {
    return ReturnsOfScan(ScanOfReturn(return_id));
  }
  void SetRanges(const std::vector<double>& ranges_m);
  void SetBearings(const std::vector<double>& bearings_rad);
  void Correct(const MeasurementCorrections& corrections);

  Status status_;
  std::vector<FixedPose> gauge_;  // the first pose at its initial guess; empty if factors hold it
  std::vector<FixedPose> fixed_poses_;
  std::map<int, std::size_t> index_of_fixed_pose_;
  std::vector<LaserBeams> lasers_;
  std::map<LaserModel, int> laser_ids_;  // the first of equal ones
  std::vector<double> timestamps_s_;
  std::vector<ScanEntry> scans_;
  std::vector<ScanIndex> scan_index_;  // per scan
  std::vector<int> scan_of_block_;     // of the first return of each block
  LaserReturns returns_;
  std::vector<std::uint16_t> low_beam_;  // per return: beam modulo ScanReturns::kSmallBeams
  std::vector<bool> moves_;              // per return, up to the last one that does
  std::vector<float> off_beam_rad_;  // of returns with bearings of their own: off their beams' ones
  std::vector<OdometryConstraint> odometry_;
  std::vector<RelativePoseConstraint> relative_poses_;
  std::vector<CustomFactor> factors_;
  std::map<std::string, int> residuals_of_factor_;  // their number by name
  std::vector<double> initial_poses_;
  const Peers* peers_ = nullptr;
  std::vector<int> rank_of_pose_;
  std::vector<ScanEntry> all_scans_;  // empty without peers
  std::vector<int> id_among_all_;     // per scan
};

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_SLAM_GRAPH_H_
