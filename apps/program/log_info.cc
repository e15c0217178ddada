#include "plumbline/apps/program/log_info.h"

#include <algorithm>
#include <iomanip>
#include <map>
#include <memory>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "plumbline/apps/bags/bag_container.h"
#include "plumbline/apps/bags/open_bag.h"
#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/text_reader.h"
#include "plumbline/apps/readers/pose_graph_input.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/median.h"

namespace plumbline {
namespace {

// Messages of one topic, or records of one kind.
struct StreamInfo {
  std::size_t num_messages = 0;
  double first_s = 0.0, last_s = 0.0;  // by the clock of the recorder

  void Add(double time_s) {
    if (num_messages++ == 0) first_s = time_s;
    last_s = time_s;
  }
};

std::string Fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string TimeText(double first_s, double last_s, std::size_t count) {
  const double duration_s = last_s - first_s;
  std::string text = Fixed(first_s, 3) + " s to " + Fixed(last_s, 3) + " s";
  if (duration_s > 0.0 && count > 1) {
    text += ", " + Fixed(static_cast<double>(count - 1) / duration_s, 1) + " Hz";
  }
  return text;
}

Status TopicsText(const std::string& path, double max_bytes, std::string* text) {
  std::unique_ptr<BagContainer> bag;
  PLUMBLINE_RETURN_IF_ERROR(OpenBag(path, &bag, max_bytes));
  std::map<BagTopic, StreamInfo> topics;
  PLUMBLINE_RETURN_IF_ERROR(bag->ReadMessages(
      [&](const BagTopic& topic) {
        topics[topic];
        return true;
      },
      [&](const BagTopic& topic, double time_s, std::string_view) {
        topics[topic].Add(time_s);
        return Status::Ok();
      }));
  *text += "bag of ROS\n";
  for (const auto& [topic, info] : topics) {
    *text += "  topic " + Printable(topic.name, 200) + " (" + Printable(topic.type, 200) + ", " +
             Printable(topic.encoding) + "): " + std::to_string(info.num_messages) + " messages";
    if (info.num_messages > 0) {
      *text += ", recorded from " + TimeText(info.first_s, info.last_s, info.num_messages);
    }
    *text += '\n';
  }
  return Status::Ok();
}

Status RecordsText(const std::string& path, std::string* text) {
  TextReader reader;
  PLUMBLINE_RETURN_IF_ERROR(reader.Open(path));
  std::map<std::string, std::size_t> counts;
  constexpr std::size_t kMaxKinds = 30;
  std::string_view line;
  while (reader.NextLine(&line)) {
    const std::string keyword = Printable(FieldReader(line).Word("keyword"));
    if (keyword.empty() || keyword.front() == '#') continue;
    if (counts.size() < kMaxKinds || counts.count(keyword) > 0) ++counts[keyword];
  }
  PLUMBLINE_RETURN_IF_ERROR(reader.status());
  *text += "lines of text by their first word:";
  for (const auto& [keyword, count] : counts) {
    *text += " " + keyword + " " + std::to_string(count) + ",";
  }
  text->back() = '\n';
  return Status::Ok();
}

std::string LaserText(const LaserModel& laser) {
  const Pose2& mounting = laser.robot_from_laser;
  std::ostringstream text;
  text << laser.num_beams << " beams from " << Fixed(RadToDeg(laser.Bearing(0)), 2) << " to "
       << Fixed(RadToDeg(laser.Bearing(laser.num_beams - 1)), 2) << " deg in steps of "
       << Fixed(RadToDeg(laser.bearing_step_rad), 4) << " deg, returns from " << laser.min_range_m
       << " to " << laser.max_range_m << " m, mounted at x = " << Fixed(mounting.x, 3)
       << " m, y = " << Fixed(mounting.y, 3) << " m, yaw = " << Fixed(RadToDeg(mounting.yaw), 1)
       << " deg";
  if (laser.beam_period_s > 0.0) {
    text << ", a sweep takes " << Fixed(laser.beam_period_s * laser.num_beams, 3) << " s";
  }
  return text.str();
}

// What a graph has.
std::string GraphText(const SlamGraph& graph) {
  constexpr int kMaxLasers = 5;
  std::string text = "  used: " + std::to_string(graph.num_scans()) + " scans with " +
                     std::to_string(graph.num_returns()) + " returns at " +
                     std::to_string(graph.num_poses()) + " poses";
  const std::vector<double>& times_s = graph.timestamps_s();
  if (!times_s.empty()) {
    const auto [first, last] = std::minmax_element(times_s.begin(), times_s.end());
    text += ", " + TimeText(*first, *last, times_s.size());
  }
  text += '\n';
  for (int laser = 0; laser < std::min(graph.num_lasers(), kMaxLasers); ++laser) {
    text += "  laser: " + LaserText(graph.laser(laser)) + '\n';
  }
  if (graph.num_lasers() > kMaxLasers) {
    text += "  and " + std::to_string(graph.num_lasers() - kMaxLasers) + " other lasers\n";
  }
  if (graph.odometry().empty()) {
    text += graph.relative_poses().empty() ? "  odometry: none, the scans are matched without\n"
                                           : "  odometry: none\n";
  } else {
    double path_m = 0.0;
    for (const OdometryConstraint& step : graph.odometry()) {
      path_m += step.from_from_to.translation().norm();
    }
    text += "  odometry: " + std::to_string(graph.odometry().size()) + " steps, " +
            Fixed(path_m, 1) + " m\n";
  }
  return text;
}

std::string WarningsText(const std::vector<Warning>& warnings) {
  std::string text;
  for (const Warning& warning : warnings) text += "  " + WarningLine(warning) + '\n';
  return text;
}

Status DescribePoseGraph(const std::string& path, double max_bytes, std::string* text) {
  PoseGraphInput input;
  PLUMBLINE_RETURN_IF_ERROR(ReadPoseGraph(path, max_bytes, &input));
  *text += "pose graph (" + input.format + ") with " +
           std::to_string(input.graph.relative_poses().size()) + " edges\n" + input.note +
           GraphText(input.graph) + WarningsText(input.warnings);
  return Status::Ok();
}

}  // namespace

Status DescribeInput(const std::string& path, const LogReadOptions& options, std::string* text) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  std::string result = Legible(path) + ": ";
  if (IsPoseGraph(path)) {
    PLUMBLINE_RETURN_IF_ERROR(DescribePoseGraph(path, options.max_bytes, &result));
    *text = std::move(result);
    return Status::Ok();
  }
  PLUMBLINE_RETURN_IF_ERROR(IsBag(path) ? TopicsText(path, options.max_bytes, &result)
                                        : RecordsText(path, &result));
  LogNotes notes;
  SlamGraph graph;
  Status status = ReadLog(path, options, &notes, &graph);
  if (status.ok()) {
    result += GraphText(graph);
    if (notes.no_return_level_m) {
      result += "  no returns: readings from " + Fixed(*notes.no_return_level_m, 3) + " m on\n";
    }
    result += "  skipped: " + std::to_string(notes.counts.num_skipped_records) + " records; " +
              std::to_string(notes.counts.num_out_of_order) + " out of order\n";
  } else {
    result += "  refused: " + Legible(status.message()) + '\n';
  }
  result += WarningsText(notes.warnings);
  *text = std::move(result);
  return status;
}

}  // namespace plumbline
