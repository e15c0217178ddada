#include "plumbline/apps/io/ros_recording.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <numeric>
#include <optional>
#include <sstream>
#include <utility>

#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/ros_clock.h"
#include "plumbline/apps/io/ros_mounting.h"
#include "plumbline/apps/io/ros_odometry.h"
#include "plumbline/apps/io/ros_scans.h"
#include "plumbline/core/median.h"
#include "plumbline/core/no_return_level.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

constexpr std::size_t kMaxNotes = 10;

std::string Percent(std::size_t part, std::size_t all) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(1)
       << 100.0 * static_cast<double>(part) / static_cast<double>(all) << " %";
  return text.str();
}

// Makes a graph of one recording.
class GraphBuilder {
 public:
  GraphBuilder(const RosRecording& recording, const RosGraphOptions& options)
      : recording_(recording), options_(options), bad_odometry_(recording.bad_odometry) {}

  Status Build(int max_scans) {
    PLUMBLINE_RETURN_IF_ERROR(Located(SelectScans(recording_, options_.laser_frame, &selection_)));
    PLUMBLINE_RETURN_IF_ERROR(Located(FindRobot(recording_, selection_.laser_frame, &robot_)));
    PLUMBLINE_RETURN_IF_ERROR(ChooseClock());
    DropUnfitStamps();
    PLUMBLINE_RETURN_IF_ERROR(MountLaser());
    PLUMBLINE_RETURN_IF_ERROR(CheckBadScans());
    PLUMBLINE_RETURN_IF_ERROR(CheckOrder());
    FindTimeIncrement();
    FindNoReturns();
    SortScans();
    PLUMBLINE_RETURN_IF_ERROR(PlaceScans());
    AddWarnings();
    for (std::size_t i = 0; i < selection_.scans.size(); ++i) {
      if (max_scans > 0 && graph_.num_scans() == max_scans) break;
      if (places_.poses[i]) PLUMBLINE_RETURN_IF_ERROR(AddScan(i));
    }
    return Status::Ok();
  }

  SlamGraph&& graph() { return std::move(graph_); }
  RosGraphNotes&& notes() { return std::move(notes_); }

 private:
  Status Error(const std::string& problem) const { return Status::InvalidArgument(Text(problem)); }
  Status Located(const Status& status) const {
    return status.ok() ? status : Error(status.message());
  }
  // For people. The names of topics and frames come from the file.
  std::string Text(const std::string& problem) const {
    return recording_.path + ": " + Printable(problem, 4000);
  }
  void Warn(const std::string& id, const std::string& problem) {
    notes_.warnings.push_back({id, Text(problem)});
  }
  // scan: index into the selection.
  const RosScan& Scan(std::size_t scan) const { return recording_.scans[selection_.scans[scan]]; }
  std::string ScanName(std::size_t scan) const {
    return RosMessageName(recording_.scan_topic, selection_.scans[scan], Scan(scan).stamp_s);
  }

  // From here on stamps_s_ has the times of the selected scans.
  Status ChooseClock() {
    StreamTimes scans{recording_.scan_topic, {}, {}};
    for (const std::size_t scan : selection_.scans) {
      scans.stamps_s.push_back(recording_.scans[scan].stamp_s);
      scans.received_s.push_back(recording_.scans[scan].received_s);
    }
    const std::string why = options_.clock == RosClock::kAuto
                                ? WhyRecordClock(scans, robot_.times, options_.max_gap_s)
                                : "";
    by_record_clock_ = options_.clock == RosClock::kRecord || !why.empty();
    if (!why.empty()) {
      Warn("record_clock", why + "; the times of recording are used, as with --clock=record");
    }
    if (by_record_clock_) return UseRecordClock(std::move(scans));
    for (const StreamTimes* times : {&scans, &robot_.times}) {
      const std::string fault = StampFault(times->stamps_s);
      if (!fault.empty()) return Error(times->topic + ": " + fault);
    }
    stamps_s_ = scans.stamps_s;
    unfit_ = StampOutliers(scans, options_.max_gap_s);
    DropUnfitOdometry();
    return Status::Ok();
  }

  Status UseRecordClock(StreamTimes scans) {
    for (const StreamTimes* times : {&scans, &robot_.times}) {
      const bool are_known = std::all_of(times->received_s.begin(), times->received_s.end(),
                                         [](double time_s) { return time_s > 0.0; });
      const std::string fault = ClockFault(times->received_s);
      if (!are_known || times->received_s.size() != times->stamps_s.size() || !fault.empty()) {
        return Error(times->topic + ": the times of recording, which --clock=record asks for, " +
                     (fault.empty() ? "are not known" : "do not help: " + fault));
      }
    }
    stamps_s_ = std::move(scans.received_s);
    unfit_.assign(stamps_s_.size(), "");
    transforms_by_record_clock_ = recording_.transforms.ByRecordClock();
    // Of transforms: the samples in the order of their recording.
    if (recording_.odometry.empty() && !robot_.odometry.empty()) {
      robot_.odometry.clear();
      for (const StampedTransform& sample :
           transforms().Samples(recording_.odom_frame, robot_.frame)) {
        robot_.odometry.push_back({sample.stamp_s, InPlane(sample.parent_from_child)});
      }
    } else {
      for (std::size_t i = 0; i < robot_.odometry.size(); ++i) {
        robot_.odometry[i].timestamp_s = robot_.times.received_s[i];
      }
    }
    robot_.times.stamps_s = robot_.times.received_s;
    return Status::Ok();
  }

  const TransformTree& transforms() const {
    return transforms_by_record_clock_ ? *transforms_by_record_clock_ : recording_.transforms;
  }

  // Counts odometry messages whose stamps do not fit as bad.
  void DropUnfitOdometry() {
    if (robot_.times.stamps_s.size() != robot_.odometry.size() || recording_.odometry.empty()) {
      return;
    }
    const std::vector<std::string> unfit = StampOutliers(robot_.times, options_.max_gap_s);
    std::vector<TimedPose> odometry;
    for (std::size_t i = 0; i < unfit.size(); ++i) {
      if (unfit[i].empty()) {
        odometry.push_back(robot_.odometry[i]);
      } else {
        bad_odometry_.Add(
            unfit[i],
            RosMessageName(recording_.odom_topic, i, robot_.times.stamps_s[i]) + unfit[i]);
      }
    }
    robot_.odometry = std::move(odometry);
    robot_.times.stamps_s.clear();
    for (const TimedPose& pose : robot_.odometry) {
      robot_.times.stamps_s.push_back(pose.timestamp_s);
    }
  }

  // Keeps the scans without a fault; kinds and faults: per selected scan.
  void DropScans(const std::vector<std::string>& kinds, const std::vector<std::string>& faults) {
    std::vector<std::size_t> scans;
    std::vector<double> stamps_s;
    for (std::size_t i = 0; i < faults.size(); ++i) {
      if (faults[i].empty()) {
        scans.push_back(selection_.scans[i]);
        stamps_s.push_back(stamps_s_[i]);
      } else {
        selection_.bad.Add(kinds[i], ScanName(i) + faults[i]);
      }
    }
    selection_.scans = std::move(scans);
    stamps_s_ = std::move(stamps_s);
  }

  void DropUnfitStamps() { DropScans(unfit_, unfit_); }

  Status MountLaser() {
    PLUMBLINE_RETURN_IF_ERROR(Located(
        FindLaserPlace(transforms(), robot_.frame, selection_.laser_frame, stamps_s_, &mounting_)));
    DropScans(mounting_.kinds, mounting_.faults);
    return Status::Ok();
  }

  Status CheckBadScans() {
    const std::size_t num_scans = selection_.scans.size() + selection_.bad.num();
    const std::size_t num_bad = selection_.bad.num();
    if (num_bad <= BadRecordLimits().Of(num_scans) && 2 * num_bad <= num_scans) {
      return Status::Ok();
    }
    return Error(BadScansText());
  }

  std::string BadScansText() const {
    return selection_.bad.Text(selection_.scans.size() + selection_.bad.num(),
                               "messages on " + recording_.scan_topic);
  }

  Status CheckOrder() {
    PLUMBLINE_RETURN_IF_ERROR(CheckOrderOf(recording_.scan_topic, stamps_s_, selection_.scans));
    return CheckOrderOf(robot_.times.topic, robot_.times.stamps_s, {});
  }

  // Messages that come a little late can be sorted in; after a jump of the clock nobody can tell
  // which odometry belongs to which scan. indices: of the messages; empty: 0, 1, and so on.
  Status CheckOrderOf(const std::string& topic, const std::vector<double>& stamps_s,
                      const std::vector<std::size_t>& indices) {
    for (std::size_t i = 1; i < stamps_s.size(); ++i) {
      const double back_s = stamps_s[i - 1] - stamps_s[i];
      if (back_s > options_.max_gap_s) {
        return Error(RosMessageName(topic, indices.empty() ? i : indices[i], stamps_s[i]) +
                     "the clock jumps back by " + std::to_string(back_s) +
                     " s; cut the recording there (rosbag filter)");
      }
      if (back_s > 0.0) ++notes_.num_out_of_order;
    }
    return Status::Ok();
  }

  void FindTimeIncrement() {
    std::vector<double> increments_s;
    for (std::size_t i = 0; i < selection_.scans.size(); ++i) {
      const double increment_s = Scan(i).time_increment_s;
      increments_s.push_back(std::isfinite(increment_s) ? increment_s : 0.0);
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

  void SortScans() {
    std::vector<std::size_t> order(selection_.scans.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [this](std::size_t a, std::size_t b) { return stamps_s_[a] < stamps_s_[b]; });
    const std::vector<std::size_t> scans = selection_.scans;
    const std::vector<double> stamps_s = stamps_s_;
    for (std::size_t i = 0; i < order.size(); ++i) {
      selection_.scans[i] = scans[order[i]];
      stamps_s_[i] = stamps_s[order[i]];
    }
  }

  Status PlaceScans() {
    places_ = PlaceByOdometry(robot_.odometry, stamps_s_, options_.max_gap_s);
    for (std::size_t i = 0; i < places_.poses.size(); ++i) {
      if (!places_.poses[i]) Skip(ScanName(i) + "no odometry before and after it");
    }
    if (places_.num_held + places_.num_skipped < places_.poses.size()) return Status::Ok();
    return Error("no scan has odometry before and after it; the odometry comes from " +
                 robot_.odometry_name);
  }

  void Skip(const std::string& reason) {
    if (++notes_.num_skipped_scans > kMaxNotes) return;
    notes_.skipped_scans.push_back(Text(reason));
  }

  void AddWarnings() {
    for (const Warning& warning : robot_.warnings) Warn(warning.id, warning.message);
    const std::string ignored = recording_.transforms.IgnoredText();
    if (!ignored.empty()) {
      Warn("ignored_transforms", "transforms are ignored, as tf2 does: " + ignored);
    }
    WarnOfBadMessages();
    if (selection_.num_repeated > 0) {
      Warn("repeated_scans", std::to_string(selection_.num_repeated) + " of " +
                                 std::to_string(recording_.scans.size()) + " messages on " +
                                 recording_.scan_topic + " repeat the one before and are dropped");
    }
    if (!mounting_.is_known) {
      Warn("unknown_mounting",
           "no transform from the robot's frame '" + robot_.frame + "' to the laser's, '" +
               selection_.laser_frame +
               "': the laser is taken to sit upright at the robot's centre and to look ahead");
    }
    WarnOfAngles();
    WarnOfSparseOdometry();
  }

  void WarnOfBadMessages() {
    if (selection_.bad.num() > 0) {
      Warn("bad_messages", BadScansText());
      for (const std::string& example : selection_.bad.examples()) Skip(example);
      notes_.num_skipped_scans += selection_.bad.num() - selection_.bad.examples().size();
    }
    if (bad_odometry_.num() > 0) {
      Warn("bad_messages", bad_odometry_.Text(robot_.odometry.size() + bad_odometry_.num(),
                                              "messages on " + recording_.odom_topic));
    }
    if (recording_.bad_transforms.num() > 0) {
      Warn("bad_messages", recording_.bad_transforms.Text(recording_.num_transform_messages,
                                                          "messages of transforms"));
    }
    for (const std::string& text : mounting_.bad_samples) Warn("bad_messages", text);
  }

  void WarnOfAngles() {
    const RosScan* first = nullptr;
    std::size_t num_contradicting = 0;
    for (std::size_t i = 0; i < selection_.scans.size(); ++i) {
      if (!AnglesOf(Scan(i), options_.angle_source).contradict) continue;
      if (num_contradicting++ == 0) first = &Scan(i);
    }
    if (first == nullptr) return;
    notes_.angles_contradict = true;
    const bool by_angle_max = options_.angle_source == BeamAngleSource::kAngleMax;
    std::ostringstream text;
    text << num_contradicting << " of " << selection_.scans.size() << " scans on "
         << recording_.scan_topic << " contradict themselves: " << first->ranges.size()
         << " readings from angle_min = " << first->angle_min_rad
         << " rad in steps of angle_increment = " << first->angle_increment_rad
         << " rad do not end at angle_max = " << first->angle_max_rad << " rad; "
         << (by_angle_max ? "angle_max" : "angle_increment")
         << " is believed (--beam_direction turns the beams round)";
    Warn("beam_angles_contradict", text.str());
  }

  void WarnOfSparseOdometry() {
    const std::size_t num_scans = places_.poses.size();
    const std::size_t num_sparse = places_.num_far + places_.num_held;
    if (num_sparse == 0) return;
    Warn("sparse_odometry", Percent(num_sparse, num_scans) +
                                " of the scans have no odometry within " +
                                std::to_string(options_.max_gap_s) +
                                " s before and after: " + std::to_string(places_.num_far) +
                                " lie between messages that are further apart, and " +
                                std::to_string(places_.num_held) + " are matched without odometry");
  }

  double MaxRange(const RosScan& scan) const {
    constexpr double kLongestM = 1e5;  // FLT_MAX and the like say nothing
    const bool is_stated = scan.range_max_m <= kLongestM && selection_.range_max_is_stated;
    return is_stated ? scan.range_max_m : LaserModel().max_range_m;
  }

  void FindNoReturns() {
    std::vector<SweepReadings> sweeps;
    for (std::size_t i = 0; i < selection_.scans.size(); ++i) {
      const RosScan& scan = Scan(i);
      sweeps.push_back(
          {&scan.ranges, AnglesOf(scan, options_.angle_source).step_rad,
           selection_.range_max_is_stated ? scan.range_max_m : SweepReadings().max_range_m,
           &scan.bearings_rad});
    }
    notes_.no_return_level_m = FindNoReturnLevel(sweeps);
  }

  // The points of a cloud have no end to count them from.
  BeamDirection DirectionOf(const RosScan& scan) const {
    const bool is_stated = options_.beam_direction == BeamDirection::kStated;
    return is_stated || scan.bearings_rad.empty() ? options_.beam_direction
                                                  : BeamDirection::kUpsideDown;
  }

  double MountingSign() const { return mounting_.place.upside_down ? -1.0 : 1.0; }

  LaserModel ModelOf(const RosScan& scan) const {
    LaserModel laser;
    const double sign = MountingSign();
    BeamAngles angles = AnglesOf(scan, options_.angle_source);
    laser.num_beams = NumBeams(scan);
    TurnBeams(DirectionOf(scan), laser.num_beams, &angles.first_rad, &angles.step_rad);
    laser.first_bearing_rad = sign * angles.first_rad;
    laser.bearing_step_rad = sign * angles.step_rad;
    laser.min_range_m = std::max(laser.min_range_m, scan.range_min_m);
    laser.max_range_m = MaxRange(scan);
    if (notes_.no_return_level_m) {
      laser.max_range_m = std::min(laser.max_range_m, *notes_.no_return_level_m);
    }
    laser.beam_period_s = BeamPeriod(scan);
    laser.robot_from_laser = mounting_.place.robot_from_laser;
    return laser;
  }

  Status AddScan(std::size_t index) {
    const RosScan& scan = Scan(index);
    const Pose2& odom_from_robot = *places_.poses[index];
    const int laser = graph_.AddLaser(ModelOf(scan));
    if (!first_pose_) first_pose_ = odom_from_robot;
    const int pose = graph_.AddPose(Between(*first_pose_, odom_from_robot), stamps_s_[index]);
    AddReadings(scan, pose, laser);
    if (pose > 0 && !robot_.odometry.empty()) {
      graph_.AddOdometry({pose - 1, pose, Between(last_pose_, odom_from_robot),
                          !last_is_held_ && places_.is_held[index] == 0});
    }
    last_pose_ = odom_from_robot;
    last_is_held_ = places_.is_held[index] != 0;
    const Status& status = graph_.status();
    return status.ok() ? status : Error(ScanName(index) + status.message());
  }

  void AddReadings(const RosScan& scan, int pose, int laser) {
    if (scan.bearings_rad.empty()) {
      graph_.AddScan(pose, laser, scan.ranges);
      return;
    }
    const bool is_turned = DirectionOf(scan) != BeamDirection::kStated;
    const double sign = is_turned ? -MountingSign() : MountingSign();
    std::vector<Eigen::Vector2d> points;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      points.push_back(mounting_.place.robot_from_laser *
                       BeamEnd(scan.ranges[i], sign * scan.bearings_rad[i]));
    }
    graph_.AddPoints(pose, laser, points);
  }

  const RosRecording& recording_;
  const RosGraphOptions& options_;
  ScanSelection selection_;
  std::vector<double> stamps_s_;    // of the selected scans
  std::vector<std::string> unfit_;  // of the selected scans: why their stamps do not fit
  RosRobot robot_;
  BadRecords bad_odometry_;
  bool by_record_clock_ = false;
  std::optional<TransformTree> transforms_by_record_clock_;
  LaserPlaces mounting_;
  ScanPlaces places_;
  double time_increment_s_ = 0.0;
  RosGraphNotes notes_;
  SlamGraph graph_;
  std::optional<Pose2> first_pose_;  // in the frame of the odometry
  Pose2 last_pose_;
  bool last_is_held_ = false;
};

}  // namespace

std::string RosMessageName(const std::string& topic, std::size_t index, double stamp_s) {
  std::ostringstream text;
  text << topic << " message " << index << " (" << std::fixed << std::setprecision(6) << stamp_s
       << " s): ";
  return text.str();
}

bool FromString(const std::string& name, RosClock* clock) {
  if (name == "auto") {
    *clock = RosClock::kAuto;
  } else if (name == "header") {
    *clock = RosClock::kHeader;
  } else if (name == "record") {
    *clock = RosClock::kRecord;
  } else {
    return false;
  }
  return true;
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
