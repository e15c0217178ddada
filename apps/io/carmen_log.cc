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

CarmenScan ReadFlaser(FieldReader* fields) {
  CarmenScan scan;
  scan.ranges = ReadRanges(fields);
  const int num_beams = static_cast<int>(scan.ranges.size());
  scan.first_bearing_rad = -0.5 * kPi;
  scan.bearing_step_rad = kPi / std::max(1, num_beams % 2 == 0 ? num_beams : num_beams - 1);
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
  LogParser(std::string path, double max_bytes, CarmenLog* log)
      : path_(std::move(path)), memory_(max_bytes), log_(log) {}

  // An unreadable record is an issue of the log. InvalidArgument if there are too many to keep.
  Status ParseLine(std::string_view line, std::size_t line_number) {
    if (line.empty()) return Status::Ok();
    FieldReader fields(line);
    const std::string_view keyword = fields.Word("keyword");
    if (keyword == "FLASER" || keyword == "ROBOTLASER1") {
      CarmenScan scan = keyword == "FLASER" ? ReadFlaser(&fields) : ReadRobotLaser(&fields);
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
      return Status::Ok();
    }
    ++log_->num_records;
    if (fields.ok()) return Status::Ok();
    AddIssue({line_number, fields.field(),
              Place(line_number) + std::string(keyword) + " " + fields.error()},
             log_);
    return Status::Ok();
  }

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
  MemoryLimit memory_;
  CarmenLog* const log_;
  double flaser_max_range_m_ = kUnknown;
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

/// Lower edge [m] of the readings that stand for "no echo"; kUnknown if there are none. The rule
/// is explained at ReadCarmenLog.
double FindNoReturnLevel(const std::vector<CarmenScan>& scans) {
  double largest_m = 0.0;
  for (const CarmenScan& scan : scans) {
    for (double range_m : scan.ranges) {
      if (std::isfinite(range_m)) largest_m = std::max(largest_m, range_m);
    }
  }
  const double level_m = 0.999 * largest_m;
  const double next_m = 0.99 * largest_m;
  std::size_t num_top = 0, num_next = 0, num_lower = 0;
  for (const CarmenScan& scan : scans) {
    for (double range_m : scan.ranges) {
      if (!std::isfinite(range_m)) continue;
      ++(range_m >= level_m ? num_top : range_m >= next_m ? num_next : num_lower);
    }
  }
  const bool found = num_top >= 10 && num_top > 10 * num_next && num_next + num_lower > 0;
  if (!found) return kUnknown;
  return level_m;
}

void SetMaxRanges(double flaser_max_range_m, std::vector<CarmenScan>* scans) {
  const double no_return_level_m = FindNoReturnLevel(*scans);
  for (CarmenScan& scan : *scans) {
    if (scan.max_range_m == kUnknown) scan.max_range_m = flaser_max_range_m;
    scan.max_range_m = std::min(scan.max_range_m, no_return_level_m);
    if (scan.max_range_m == kUnknown) scan.max_range_m = LaserModel().max_range_m;
  }
}

std::string FirstIssue(const CarmenLog& log) {
  return log.issues.empty() ? "" : "; first issue: " + log.issues.front().message;
}

}  // namespace

bool CarmenReadOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION(max_bad_share, >=, 0.0);
  PLUMBLINE_CHECK_OPTION(max_bad_share, <=, 1.0);
  PLUMBLINE_CHECK_OPTION(max_bad_records, >=, 0);
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
  LogParser parser(path, options.max_bytes, &result);
  std::string_view line;
  while (reader.NextLine(&line)) {
    PLUMBLINE_RETURN_IF_ERROR(parser.ParseLine(line, reader.line_number()));
  }
  PLUMBLINE_RETURN_IF_ERROR(reader.status());

  const double limit =
      std::max<double>(options.max_bad_records, options.max_bad_share * result.num_records);
  if (result.num_issues > limit) {
    return Status::DataLoss(
        path + ": " + std::to_string(result.num_issues) + " of " +
        std::to_string(result.num_records) + " records are unreadable, more than the " +
        std::to_string(static_cast<int>(limit)) + " allowed" + FirstIssue(result));
  }
  if (reader.truncated()) {
    const std::string last_line = std::to_string(reader.line_number());
    AddIssue({reader.line_number() + 1, "end of file",
              path + ": the compressed file is truncated after line " + last_line},
             &result);
  }
  if (result.scans.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(RefuseForeignName(path));
    return Status::InvalidArgument(path + ": no FLASER or ROBOTLASER1 record, as a CARMEN log has" +
                                   FirstIssue(result));
  }
  SetMaxRanges(parser.flaser_max_range_m(), &result.scans);
  result.num_out_of_order = SortByTime(&result.scans);
  *log = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
