#include "plumbline/apps/io/ros_scans.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "plumbline/core/angle.h"
#include "plumbline/core/laser_scan.h"

namespace plumbline {
namespace {

bool IsStated(double range_max_m) { return range_max_m > 0.0; }

bool IsRepeated(const RosScan& scan, const RosScan& before) {
  return scan.stamp_s == before.stamp_s && scan.ranges.size() == before.ranges.size() &&
         scan.bearings_rad == before.bearings_rad &&
         std::memcmp(scan.ranges.data(), before.ranges.data(),
                     scan.ranges.size() * sizeof(double)) == 0;
}

std::map<std::string, std::size_t> CountFrames(const RosRecording& recording) {
  std::map<std::string, std::size_t> counts;
  for (const RosScan& scan : recording.scans) {
    if (scan.fault.empty()) ++counts[scan.frame];
  }
  return counts;
}

Status ChooseFrame(const RosRecording& recording, const std::string& wanted, std::string* frame) {
  const std::map<std::string, std::size_t> counts = CountFrames(recording);
  std::string text;
  std::size_t num_scans = 0, num_most = 0;
  for (const auto& [name, count] : counts) {
    text += (text.empty() ? "'" : ", '") + name + "' (" + std::to_string(count) + " scans)";
    num_scans += count;
    if (count > num_most) *frame = name;
    num_most = std::max(num_most, count);
  }
  if (!wanted.empty()) {
    *frame = wanted;
    if (counts.count(wanted) > 0) return Status::Ok();
    return Status::InvalidArgument("no scan on " + recording.scan_topic + " is of the frame '" +
                                   wanted + "', as --laser_frame asks for; the frames are " + text);
  }
  const std::size_t num_others = num_scans - num_most;
  if (num_others == 0 ||
      (num_others <= BadRecordLimits().Of(num_scans) && num_most > num_others * 4)) {
    return Status::Ok();
  }
  return Status::InvalidArgument("several lasers share " + recording.scan_topic +
                                 ": choose one by --laser_frame; the frames are " + text);
}

}  // namespace

int NumBeams(const RosScan& scan) {
  return scan.bearings_rad.empty()
             ? static_cast<int>(scan.ranges.size())
             : static_cast<int>(std::lround(2.0 * kPi / std::abs(scan.angle_increment_rad)));
}

BeamAngles AnglesOf(const RosScan& scan, BeamAngleSource source) {
  // Drivers count the last step or leave it out, and round the increment.
  constexpr double kToleranceSteps = 1.5;
  const double step = scan.angle_increment_rad;
  const bool has_step = std::isfinite(step) && step != 0.0;
  BeamAngles angles{scan.angle_min_rad, has_step ? step : 0.0, false};
  const auto num_steps = static_cast<double>(scan.ranges.size()) - 1.0;
  const double span = scan.angle_max_rad - scan.angle_min_rad;
  if (!std::isfinite(span) || span == 0.0 || num_steps < 1.0) return angles;
  const bool is_full_turn = std::abs(std::abs(span) - 2.0 * kPi) < 1e-3;
  const double step_by_span = span / (is_full_turn ? num_steps + 1.0 : num_steps);
  if (!has_step) {
    angles.step_rad = step_by_span;
    return angles;
  }
  const double tolerance = kToleranceSteps * std::abs(step);
  const double covered = num_steps * step;
  if (std::abs(span - covered) <= tolerance) return angles;
  const bool is_reversed = std::abs(span + covered) <= tolerance;
  // Some drivers give angle_max within a turn, others leave it zero.
  const bool is_wrapped = std::abs(NormalizeAngle(span - covered)) <= tolerance;
  if (!is_reversed && (is_wrapped || scan.angle_max_rad == 0.0)) return angles;
  angles.contradict = true;
  if (source == BeamAngleSource::kAngleMax) angles.step_rad = is_reversed ? -step : step_by_span;
  return angles;
}

std::string ScanFault(const RosScan& scan, bool range_max_is_stated) {
  if (!scan.fault.empty()) return scan.fault;
  if (scan.ranges.empty()) return "field 'ranges' is empty";
  if (!std::isfinite(scan.angle_min_rad)) return "field 'angle_min' is not finite";
  if (AnglesOf(scan, BeamAngleSource::kAngleMax).step_rad == 0.0) {
    return "field 'angle_increment' is zero or not finite";
  }
  if (std::isnan(scan.range_min_m)) return "field 'range_min' is not a number";
  if (range_max_is_stated && !(scan.range_max_m > std::max(scan.range_min_m, 0.0))) {
    return "field 'range_max' is not above range_min and zero";
  }
  LaserModel laser;
  const BeamAngles angles = AnglesOf(scan, BeamAngleSource::kAngleMax);
  laser.num_beams = NumBeams(scan);
  laser.first_bearing_rad = angles.first_rad;
  laser.bearing_step_rad = angles.step_rad;
  std::string fault;
  return laser.Check(&fault) ? "" : fault;
}

Status SelectScans(const RosRecording& recording, const std::string& laser_frame,
                   ScanSelection* selection) {
  const std::vector<RosScan>& scans = recording.scans;
  if (scans.empty()) {
    return Status::InvalidArgument("there is no message on " + recording.scan_topic);
  }
  ScanSelection result;
  PLUMBLINE_RETURN_IF_ERROR(ChooseFrame(recording, laser_frame, &result.laser_frame));
  result.range_max_is_stated = std::any_of(
      scans.begin(), scans.end(), [](const RosScan& scan) { return IsStated(scan.range_max_m); });
  const RosScan* before = nullptr;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const RosScan& scan = scans[i];
    std::string fault = ScanFault(scan, result.range_max_is_stated);
    if (fault.empty() && scan.frame != result.laser_frame) {
      if (!laser_frame.empty()) continue;
      fault = "field 'header.frame_id' is '" + scan.frame + "', but '" + result.laser_frame +
              "' in the others";
    }
    if (!fault.empty()) {
      const double time_s = scan.fault.empty() ? scan.stamp_s : scan.received_s;
      result.bad.Add(fault, RosMessageName(recording.scan_topic, i, time_s) + fault);
    } else if (before != nullptr && IsRepeated(scan, *before)) {
      ++result.num_repeated;
    } else {
      result.scans.push_back(i);
      before = &scan;
    }
  }
  *selection = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
