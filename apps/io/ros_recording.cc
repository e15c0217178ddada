#include "plumbline/apps/io/ros_recording.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iterator>
#include <numeric>
#include <optional>
#include <sstream>
#include <utility>

#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/pose_timeline.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

// Beyond this the cut through the building is no longer the one at the laser's height.
constexpr double kMaxTiltRad = DegToRad(3.0);
// What transforms that are meant to rest may differ by.
constexpr double kRestM = 0.01, kRestRad = 0.01;
constexpr std::size_t kMaxNotes = 10;

// Where a laser sits on the robot. Hung upside down, its bearings run clockwise.
struct Mounting {
  Pose2 robot_from_laser;
  bool upside_down = false;

  bool IsNear(const Mounting& other) const {
    const Pose2 change = Between(robot_from_laser, other.robot_from_laser);
    return upside_down == other.upside_down && change.translation().norm() <= kRestM &&
           std::abs(change.yaw) <= kRestRad;
  }
};

// Empty, or what makes a scan no sweep of a laser.
std::string FaultOf(const RosScan& scan) {
  if (!std::isfinite(scan.stamp_s) || scan.stamp_s <= 0.0) return "field 'header.stamp' is not set";
  if (scan.ranges.empty()) return "field 'ranges' is empty";
  if (!std::isfinite(scan.angle_min_rad)) return "field 'angle_min' is not finite";
  if (!std::isfinite(scan.angle_increment_rad) || scan.angle_increment_rad == 0.0) {
    return "field 'angle_increment' is zero or not finite";
  }
  if (!(scan.range_max_m > std::max(scan.range_min_m, 0.0))) {
    return "field 'range_max' is not above range_min and zero";
  }
  return "";
}

int NumBeams(const RosScan& scan) {
  return scan.bearings_rad.empty()
             ? static_cast<int>(scan.ranges.size())
             : static_cast<int>(std::lround(2.0 * kPi / std::abs(scan.angle_increment_rad)));
}

LaserModel ModelOf(const RosScan& scan, double beam_period_s, const Mounting& mounting) {
  LaserModel laser;
  const double sign = mounting.upside_down ? -1.0 : 1.0;
  laser.num_beams = NumBeams(scan);
  laser.first_bearing_rad = sign * scan.angle_min_rad;
  laser.bearing_step_rad = sign * scan.angle_increment_rad;
  laser.min_range_m = std::max(laser.min_range_m, scan.range_min_m);
  if (std::isfinite(scan.range_max_m)) laser.max_range_m = scan.range_max_m;
  laser.beam_period_s = beam_period_s;
  laser.robot_from_laser = mounting.robot_from_laser;
  return laser;
}

// Makes a graph of one recording.
class GraphBuilder {
 public:
  GraphBuilder(const RosRecording& recording, const RosGraphOptions& options)
      : recording_(recording), options_(options) {}

  Status Build(int max_scans) {
    PLUMBLINE_RETURN_IF_ERROR(CheckScans());
    PLUMBLINE_RETURN_IF_ERROR(CheckClocks());
    PLUMBLINE_RETURN_IF_ERROR(FindRobot());
    FindTimeIncrement();
    for (const std::size_t i : ScansInOrderOfTime()) {
      if (max_scans > 0 && graph_.num_scans() == max_scans) break;
      PLUMBLINE_RETURN_IF_ERROR(AddScan(i));
    }
    if (graph_.num_scans() > 0) return Status::Ok();
    return Error("no scan has odometry within " + std::to_string(options_.max_gap_s) +
                 " s before and after it; the odometry comes from " + OdometryName());
  }

  SlamGraph&& graph() { return std::move(graph_); }
  RosGraphNotes&& notes() { return std::move(notes_); }

 private:
  Status Error(const std::string& problem) const { return Status::InvalidArgument(Text(problem)); }
  // For people. The names of topics and frames come from the file.
  std::string Text(const std::string& problem) const {
    return recording_.path + ": " + Printable(problem, 4000);
  }
  std::string ScanName(std::size_t index) const {
    return RosMessageName(recording_.scan_topic, index, recording_.scans[index].stamp_s);
  }
  bool odometry_is_in_messages() const { return !recording_.odom_topic.empty(); }
  std::string OdometryName() const {
    return odometry_is_in_messages()
               ? recording_.odom_topic
               : "the transform of '" + robot_frame_ + "' in '" + recording_.odom_frame + "'";
  }
  const std::string& laser_frame() const { return recording_.scans.front().frame; }

  Status CheckScans() const {
    if (recording_.scans.empty()) return Error("there is no message on " + recording_.scan_topic);
    for (std::size_t i = 0; i < recording_.scans.size(); ++i) {
      const RosScan& scan = recording_.scans[i];
      const std::string fault = FaultOf(scan);
      if (!fault.empty()) return Error(ScanName(i) + fault);
      if (scan.frame != laser_frame()) {
        return Error(ScanName(i) + "field 'header.frame_id' is '" + scan.frame + "', but '" +
                     laser_frame() + "' before: one laser is expected");
      }
    }
    return Status::Ok();
  }

  Status CheckClocks() {
    std::vector<double> stamps_s;
    for (const RosScan& scan : recording_.scans) stamps_s.push_back(scan.stamp_s);
    PLUMBLINE_RETURN_IF_ERROR(CheckClock(recording_.scan_topic, stamps_s));
    stamps_s.clear();
    for (const TimedPose& pose : recording_.odometry) stamps_s.push_back(pose.timestamp_s);
    return CheckClock(recording_.odom_topic, stamps_s);
  }

  // Messages that come a little late can be sorted in; after a jump of the clock nobody can tell
  // which odometry belongs to which scan.
  Status CheckClock(const std::string& topic, const std::vector<double>& stamps_s) {
    const std::string fault = ClockFault(stamps_s);
    if (!fault.empty()) return Error(topic + ": " + fault);
    for (std::size_t i = 1; i < stamps_s.size(); ++i) {
      const double back_s = stamps_s[i - 1] - stamps_s[i];
      if (back_s > options_.max_gap_s) {
        return Error(RosMessageName(topic, i, stamps_s[i]) + "the clock jumps back by " +
                     std::to_string(back_s) + " s; cut the recording there (rosbag filter)");
      }
      if (back_s > 0.0) ++notes_.num_out_of_order;
    }
    return Status::Ok();
  }

  // The frame that the odometry moves, and its poses.
  Status FindRobot() {
    if (odometry_is_in_messages() && !recording_.odometry.empty()) {
      robot_frame_ = recording_.robot_frame;
      TakeOdometry(recording_.odometry);
      return Status::Ok();
    }
    std::vector<std::string> path;
    const Status status = recording_.transforms.PathUp(laser_frame(), &path);
    if (!status.ok()) return Error(status.message());
    const auto odom = std::find(path.begin(), path.end(), recording_.odom_frame);
    if (odom == path.end() || odom == path.begin() || odometry_is_in_messages()) {
      if (!recording_.needs_odometry) return GoWithoutOdometry(path);
      if (odometry_is_in_messages()) return Error("there is no message on " + OdometryName());
      return Error("there is no odometry: no nav_msgs/Odometry, and no frame '" +
                   recording_.odom_frame + "' above the laser's, '" + laser_frame() +
                   "', in the transforms; frames: " + recording_.transforms.FrameNames());
    }
    robot_frame_ = *std::prev(odom);
    std::vector<TimedPose> poses;
    for (const StampedTransform& sample : recording_.transforms.Samples(robot_frame_)) {
      poses.push_back({sample.stamp_s, InPlane(sample.parent_from_child)});
    }
    TakeOdometry(std::move(poses));
    return Status::Ok();
  }

  void FindTimeIncrement() {
    std::vector<double> increments_s;
    for (const RosScan& scan : recording_.scans) {
      increments_s.push_back(std::isfinite(scan.time_increment_s) ? scan.time_increment_s : 0.0);
    }
    time_increment_s_ = Median(std::move(increments_s));
  }

  double BeamPeriod(const RosScan& scan) const {
    constexpr double kMaxSweepS = 1.0;
    const auto num_beams = static_cast<double>(NumBeams(scan));
    if (options_.sweep_time_s) return *options_.sweep_time_s / num_beams;
    const double sweep_time_s = time_increment_s_ * num_beams;
    return sweep_time_s > 0.0 && sweep_time_s <= kMaxSweepS ? time_increment_s_ : 0.0;
  }

  // Poses that are all the same are no odometry.
  void TakeOdometry(std::vector<TimedPose> poses) {
    const auto moved = [&](const TimedPose& pose) {
      const Pose2 &a = poses.front().world_from_robot, &b = pose.world_from_robot;
      return a.x != b.x || a.y != b.y || a.yaw != b.yaw;
    };
    if (std::any_of(poses.begin(), poses.end(), moved)) timeline_.emplace(std::move(poses));
  }

  // path: from the laser's frame to the root. The robot is as far up as nothing moves.
  Status GoWithoutOdometry(const std::vector<std::string>& path) {
    robot_frame_ = path.front();
    for (std::size_t i = 1; i < path.size(); ++i) {
      if (!IsAtRest(recording_.transforms.Samples(path[i - 1]))) {
        notes_.warnings.push_back(Text("the frame '" + robot_frame_ + "' moves in '" + path[i] +
                                       "': --odom_frame=" + path[i] + " takes that as odometry"));
        break;
      }
      robot_frame_ = path[i];
    }
    return Status::Ok();
  }

  static bool IsAtRest(const std::vector<StampedTransform>& samples) {
    const auto mounting = [](const StampedTransform& sample) {
      return Mounting{InPlane(sample.parent_from_child)};
    };
    return std::all_of(samples.begin(), samples.end(), [&](const StampedTransform& sample) {
      return mounting(samples.front()).IsNear(mounting(sample));
    });
  }

  // Where the robot was by its odometry; the origin if there is none. Empty outside of it.
  std::optional<Pose2> OdomFromRobot(double stamp_s) const {
    return timeline_ ? timeline_->Interpolate(stamp_s, options_.max_gap_s) : Pose2();
  }

  std::vector<std::size_t> ScansInOrderOfTime() const {
    std::vector<std::size_t> order(recording_.scans.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
      return recording_.scans[a].stamp_s < recording_.scans[b].stamp_s;
    });
    return order;
  }

  Status AddScan(std::size_t index) {
    const RosScan& scan = recording_.scans[index];
    const std::optional<Pose2> odom_from_robot = OdomFromRobot(scan.stamp_s);
    if (!odom_from_robot) {
      Skip(ScanName(index) + "no odometry before and after it");
      return Status::Ok();
    }
    PLUMBLINE_RETURN_IF_ERROR(UpdateMounting(index));
    int laser = 0, pose = 0;
    const Status status = graph_.AddLaser(ModelOf(scan, BeamPeriod(scan), *mounting_), &laser);
    if (!status.ok()) return Error(ScanName(index) + status.message());
    if (!first_pose_) first_pose_ = odom_from_robot;
    PLUMBLINE_RETURN_IF_ERROR(
        graph_.AddPose(Between(*first_pose_, *odom_from_robot), scan.stamp_s, &pose));
    PLUMBLINE_RETURN_IF_ERROR(AddReadings(scan, pose, laser));
    if (pose > 0 && timeline_) {
      PLUMBLINE_RETURN_IF_ERROR(
          graph_.AddOdometry({pose - 1, pose, Between(last_pose_, *odom_from_robot)}));
    }
    last_pose_ = *odom_from_robot;
    return Status::Ok();
  }

  Status AddReadings(const RosScan& scan, int pose, int laser) {
    if (scan.bearings_rad.empty()) return graph_.AddScan(pose, laser, scan.ranges);
    const double sign = mounting_->upside_down ? -1.0 : 1.0;
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      points.push_back(mounting_->robot_from_laser *
                       BeamEnd(scan.ranges[i], sign * scan.bearings_rad[i]));
    }
    return graph_.AddPoints(pose, laser, points);
  }

  void Skip(const std::string& reason) {
    if (++notes_.num_skipped_scans > kMaxNotes) return;
    notes_.skipped_scans.push_back(Text(reason));
  }

  // The first scan tells the mounting, the others must agree.
  Status UpdateMounting(std::size_t index) {
    std::optional<Mounting> mounting;
    PLUMBLINE_RETURN_IF_ERROR(FindMounting(index, &mounting));
    if (!mounting_) {
      if (!mounting) WarnOfUnknownMounting();
      mounting_ = mounting.value_or(Mounting());
    } else if (mounting && !mounting_->IsNear(*mounting)) {
      return Error(ScanName(index) + "the laser's frame '" + laser_frame() +
                   "' has moved on the robot, '" + robot_frame_ + "': one at rest is expected");
    }
    return Status::Ok();
  }

  // Empty without a transform.
  Status FindMounting(std::size_t index, std::optional<Mounting>* mounting) const {
    std::optional<Eigen::Isometry3d> robot_from_laser;
    const Status status = recording_.transforms.Find(
        robot_frame_, laser_frame(), recording_.scans[index].stamp_s, &robot_from_laser);
    if (!status.ok()) return Error(status.message());
    if (!robot_from_laser) return Status::Ok();
    const double upright = robot_from_laser->linear()(2, 2);
    if (std::abs(upright) < std::cos(kMaxTiltRad)) {
      return Error("the laser's frame '" + laser_frame() + "' is tilted by " +
                   std::to_string(RadToDeg(std::acos(std::abs(upright)))) + " deg in '" +
                   robot_frame_ + "': its sweeps are no horizontal cuts");
    }
    *mounting = Mounting{InPlane(*robot_from_laser), upright < 0.0};
    return Status::Ok();
  }

  void WarnOfUnknownMounting() {
    notes_.warnings.push_back(
        Text("no transform from the robot's frame '" + robot_frame_ + "' to the laser's, '" +
             laser_frame() +
             "': the laser is taken to sit upright at the robot's centre and to look ahead"));
  }

  const RosRecording& recording_;
  const RosGraphOptions& options_;
  RosGraphNotes notes_;
  SlamGraph graph_;
  std::string robot_frame_;
  std::optional<PoseTimeline> timeline_;  // none without odometry
  double time_increment_s_ = 0.0;
  std::optional<Mounting> mounting_;
  std::optional<Pose2> first_pose_;  // in the frame of the odometry
  Pose2 last_pose_;
};

}  // namespace

std::string RosMessageName(const std::string& topic, std::size_t index, double stamp_s) {
  std::ostringstream text;
  text << topic << " message " << index << " (" << std::fixed << std::setprecision(6) << stamp_s
       << " s): ";
  return text.str();
}

bool RosGraphOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_FINITE_OPTION(max_gap_s, >, 0.0);
  if (sweep_time_s) PLUMBLINE_CHECK_OPTION_WITHIN(*sweep_time_s, 0.0, 60.0);
  return true;
}

Status BuildGraph(const RosRecording& recording, const RosGraphOptions& options, int max_scans,
                  RosGraphNotes* notes, SlamGraph* graph) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument(error);
  if (max_scans < 0) {
    return Status::InvalidArgument("max_scans = " + std::to_string(max_scans) +
                                   ", but it must be >= 0");
  }
  GraphBuilder builder(recording, options);
  PLUMBLINE_RETURN_IF_ERROR(builder.Build(max_scans));
  *notes = builder.notes();
  *graph = builder.graph();
  return Status::Ok();
}

}  // namespace plumbline
