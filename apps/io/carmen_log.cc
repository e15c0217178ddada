#include "plumbline/apps/io/carmen_log.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/foreign_format.h"
#include "plumbline/apps/io/memory_limit.h"
#include "plumbline/apps/io/text_reader.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/laser_scan.h"
#include "plumbline/core/no_return_level.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

constexpr std::size_t kMaxIssuesKept = 10;
constexpr double kUnknown = std::numeric_limits<double>::infinity();

Pose2 ReadPose(FieldReader* fields, const char* x, const char* y, const char* theta) {
  Pose2 pose;
  pose.x = fields->Coordinate(x);
  pose.y = fields->Coordinate(y);
  pose.yaw = fields->Yaw(theta);
  return pose;
}

/// The three fields that close every message; returns ipc_timestamp.
double ReadTrailer(FieldReader* fields) {
  const double timestamp_s = fields->Time("ipc_timestamp");
  fields->Word("host");
  fields->FiniteNumber("logger_timestamp");
  fields->ExpectEnd();
  return timestamp_s;
}

std::vector<double> ReadRanges(FieldReader* fields) {
  const int num_beams = fields->Count("num_readings");
  if (num_beams == 0) fields->Fail("num_readings", "a scan needs at least one beam");
  return fields->Numbers("range", num_beams);
}

CarmenScan ReadFlaser(const std::optional<double>& fov_rad, FieldReader* fields) {
  CarmenScan scan;
  scan.ranges = ReadRanges(fields);
  const int num_beams = static_cast<int>(scan.ranges.size());
  SetFlaserBearings(num_beams, fov_rad, &scan.first_bearing_rad, &scan.bearing_step_rad);
  scan.max_range_m = kUnknown;
  scan.odom_from_laser = ReadPose(fields, "laser_x", "laser_y", "laser_theta");
  scan.odom_from_robot = ReadPose(fields, "odom_x", "odom_y", "odom_theta");
  scan.timestamp_s = ReadTrailer(fields);
  return scan;
}

CarmenScan ReadRobotLaser(FieldReader* fields) {
  CarmenScan scan;
  fields->Number("laser_type");
  scan.first_bearing_rad = fields->FiniteNumber("start_angle");
  fields->Number("fov");
  scan.bearing_step_rad = fields->PositiveNumber("angular_resolution");
  scan.max_range_m = fields->PositiveNumber("max_range");
  fields->Number("accuracy");
  fields->Number("remission_mode");
  scan.ranges = ReadRanges(fields);
  fields->Numbers("remission", fields->Count("num_remissions"));
  scan.odom_from_laser = ReadPose(fields, "laser_x", "laser_y", "laser_theta");
  scan.odom_from_robot = ReadPose(fields, "robot_x", "robot_y", "robot_theta");
  for (const char* field : {"laser_tv", "laser_rv", "forward_safety", "side_safety", "turn_axis"}) {
    fields->Number(field);
  }
  scan.timestamp_s = ReadTrailer(fields);
  return scan;
}

// Every scan comes with its odometry: these records tell nothing more.
void CheckOdometry(FieldReader* fields) {
  ReadPose(fields, "x", "y", "theta");
  for (const char* field : {"tv", "rv", "accel"}) fields->Number(field);
  ReadTrailer(fields);
}

// BuildGraph frees a scan once the graph has it.
std::size_t BytesOf(const CarmenScan& scan) {
  return sizeof(scan) + scan.ranges.size() * sizeof(double);
}

void AddIssue(CarmenIssue issue, CarmenLog* log) {
  ++log->num_issues;
  if (log->issues.size() < kMaxIssuesKept) log->issues.push_back(std::move(issue));
}

/// Fills a log from the lines of one file.
class LogParser {
 public:
  LogParser(std::string path, const CarmenReadOptions& options, CarmenLog* log)
      : path_(std::move(path)),
        fov_rad_(options.flaser_fov_rad),
        memory_(options.max_bytes),
        log_(log) {}

  // An unreadable record is an issue of the log. InvalidArgument if there are too many to keep.
  Status ParseLine(std::string_view line, std::size_t line_number) {
    if (line.empty()) return Status::Ok();
    FieldReader fields(line);
    const std::string_view keyword = fields.Word("keyword");
    if (keyword == "FLASER" || keyword == "ROBOTLASER1") {
      CarmenScan scan =
          keyword == "FLASER" ? ReadFlaser(fov_rad_, &fields) : ReadRobotLaser(&fields);
      scan.is_flaser = keyword == "FLASER";
      scan.line = line_number;
      if (fields.ok()) {
        if (!memory_.Keep(BytesOf(scan))) return Error(line_number, memory_.Fault());
        log_->scans.push_back(std::move(scan));
      }
    } else if (keyword == "ODOM") {
      CheckOdometry(&fields);
    } else if (keyword == "PARAM") {
      if (!memory_.Keep(line.size())) return Error(line_number, memory_.Fault());
      ReadParam(&fields);
    } else {
      if (keyword.substr(0, 8) == "RAWLASER") ++num_raw_scans_;
      return Status::Ok();
    }
    ++log_->num_records;
    if (fields.ok()) return Status::Ok();
    AddIssue({line_number, fields.field(),
              Place(line_number) + std::string(keyword) + " " + fields.error()},
             log_);
    return Status::Ok();
  }

  /// Number of scans that come without a pose of the robot.
  std::size_t num_raw_scans() const { return num_raw_scans_; }

  /// Of FLASER records, as the log's parameters state it.
  double flaser_max_range_m() const { return flaser_max_range_m_; }

 private:
  std::string Place(std::size_t line) const { return path_ + ":" + std::to_string(line) + ": "; }
  Status Error(std::size_t line, const std::string& problem) const {
    return Status::InvalidArgument(Place(line) + problem);
  }

  void ReadParam(FieldReader* fields) {
    const std::string name(fields->Word("name"));
    FieldReader number = *fields;
    const std::string value(fields->Word("value"));
    if (name == "robot_front_laser_max") {
      const double max_range_m = number.PositiveNumber("value");
      if (number.ok()) {
        flaser_max_range_m_ = max_range_m;
      } else {
        *fields = number;
      }
    }
    if (fields->ok()) log_->params[name] = value;
  }

  const std::string path_;
  const std::optional<double> fov_rad_;
  MemoryLimit memory_;
  CarmenLog* const log_;
  double flaser_max_range_m_ = kUnknown;
  std::size_t num_raw_scans_ = 0;
};

/// Sorts by time, if the clock is worth it, and returns how many scans were older than their
/// predecessor.
std::size_t SortByTime(std::vector<CarmenScan>* scans) {
  const auto older = [](const CarmenScan& a, const CarmenScan& b) {
    return a.timestamp_s < b.timestamp_s;
  };
  std::size_t num_out_of_order = 0;
  for (std::size_t i = 1; i < scans->size(); ++i) {
    if (older((*scans)[i], (*scans)[i - 1])) ++num_out_of_order;
  }
  if (num_out_of_order == 0) return 0;
  std::vector<double> times_s;
  times_s.reserve(scans->size());
  for (const CarmenScan& scan : *scans) times_s.push_back(scan.timestamp_s);
  if (!ClockFault(times_s).empty()) return 0;
  std::stable_sort(scans->begin(), scans->end(), older);
  return num_out_of_order;
}

// Readings beyond the stated maximum range show the level as well, unless it lies up there.
void FindLevel(CarmenLog* log) {
  std::vector<SweepReadings> sweeps;
  double max_range_m = 0.0;
  for (const CarmenScan& scan : log->scans) {
    sweeps.push_back({&scan.ranges, scan.bearing_step_rad});
    max_range_m = std::max(max_range_m, scan.max_range_m);
  }
  log->no_return_level_m = FindNoReturnLevel(sweeps);
  if (log->no_return_level_m.value_or(0.0) < max_range_m) return;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    sweeps[i].max_range_m = log->scans[i].max_range_m;
  }
  log->no_return_level_m = FindNoReturnLevel(sweeps);
}

void SetMaxRanges(double flaser_max_range_m, CarmenLog* log) {
  for (CarmenScan& scan : log->scans) {
    if (scan.max_range_m == kUnknown) scan.max_range_m = flaser_max_range_m;
  }
  FindLevel(log);
  for (CarmenScan& scan : log->scans) {
    scan.max_range_m = std::min(scan.max_range_m, log->no_return_level_m.value_or(kUnknown));
    if (scan.max_range_m == kUnknown) scan.max_range_m = LaserModel().max_range_m;
  }
}

std::string FirstIssue(const CarmenLog& log) {
  return log.issues.empty() ? "" : "; first issue: " + log.issues.front().message;
}

}  // namespace

void SetFlaserBearings(int num_beams, const std::optional<double>& fov_rad, double* first_rad,
                       double* step_rad) {
  const bool is_three_quarters = num_beams == 541 || num_beams == 1081;
  if (!fov_rad && !is_three_quarters) {
    *first_rad = -0.5 * kPi;
    *step_rad = kPi / std::max(1, num_beams % 2 == 0 ? num_beams : num_beams - 1);
    return;
  }
  const double angle_rad = fov_rad.value_or(1.5 * kPi);
  const bool is_full_turn = angle_rad >= 2.0 * kPi;
  *first_rad = -0.5 * angle_rad;
  *step_rad = angle_rad / std::max(1, is_full_turn ? num_beams : num_beams - 1);
}

bool CarmenReadOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_NESTED_OPTIONS(bad_records);
  PLUMBLINE_CHECK_OPTION(max_bytes, >=, 0.0);
  return true;
}

Status ReadCarmenLog(const std::string& path, const CarmenReadOptions& options, CarmenLog* log) {
  std::string error;
  if (!options.Check(&error)) return Status::InvalidArgument("CARMEN read options: " + error);
  TextReader reader;
  PLUMBLINE_RETURN_IF_ERROR(reader.Open(path));
  PLUMBLINE_RETURN_IF_ERROR(RefuseForeignContent(path));

  CarmenLog result;
  LogParser parser(path, options, &result);
  std::string_view line;
  while (reader.NextLine(&line)) {
    PLUMBLINE_RETURN_IF_ERROR(parser.ParseLine(line, reader.line_number()));
  }
  PLUMBLINE_RETURN_IF_ERROR(reader.status());

  const std::size_t limit = options.bad_records.Of(result.num_records);
  if (result.num_issues > limit) {
    return Status::DataLoss(path + ": " + std::to_string(result.num_issues) + " of " +
                            std::to_string(result.num_records) +
                            " records are unreadable, more than the " + std::to_string(limit) +
                            " allowed" + FirstIssue(result));
  }
  if (reader.truncated()) {
    const std::string last_line = std::to_string(reader.line_number());
    AddIssue({reader.line_number() + 1, "end of file",
              path + ": the compressed file is truncated after line " + last_line},
             &result);
  }
  if (result.scans.empty()) {
    if (parser.num_raw_scans() > 0) {
      return Status::InvalidArgument(
          path + ": its " + std::to_string(parser.num_raw_scans()) +
          " scans are RAWLASER records, which do not say where the robot was; write each as FLASER "
          "n r1 ... rn x y theta x y theta time host time, with the poses of laser and robot by "
          "the ODOM records (CARMEN's robot module does that), or zeros without odometry" +
          FirstIssue(result));
    }
    PLUMBLINE_RETURN_IF_ERROR(RefuseForeignName(path));
    return Status::InvalidArgument(path + ": no FLASER or ROBOTLASER1 record, as a CARMEN log has" +
                                   FirstIssue(result));
  }
  SetMaxRanges(parser.flaser_max_range_m(), &result);
  result.num_out_of_order = SortByTime(&result.scans);
  *log = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
