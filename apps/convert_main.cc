// A log or a pose graph in; the same as files of other kinds out.

#include <gflags/gflags.h>

#include <iostream>
#include <string>
#include <vector>

#include "plumbline/apps/convert/convert.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/apps/program/stop_signal.h"

DEFINE_string(
    input, "",
    "CARMEN log (.clf, .log), plain or .gz; bag of ROS 1 or ROS 2, file or folder; or pose graph "
    "(g2o, TORO), plain or .gz; or map of slam_toolbox (.posegraph)");
DEFINE_string(output, "",
              "File to write, or several, separated by commas. The extension tells what it is: "
              ".tum .g2o .toro .graph .ply .pcd .pgm .yaml");
DEFINE_string(
    format, "",
    "Format of the one output, whatever its extension: tum, g2o, toro, ply, pcd, ros_map");
DEFINE_string(trajectory, "",
              "Poses to use instead of the input's (TUM: 't x y z qx qy qz qw'); each pose of the "
              "input needs one at its time, to 1 ms");
DEFINE_double(map_resolution_m, plumbline::ConvertOptions().map_resolution_m,
              "Side of a cell of a ROS map [m]");

namespace plumbline {
namespace {

constexpr char kUsage[] =
    "Turns a log or a pose graph into files of other kinds, for other programs.\n\n"
    "  plumbline_convert --input=fr079.clf.gz --output=fr079.g2o\n"
    "  plumbline_convert --input=fr079.clf.gz --trajectory=out/trajectory.tum "
    "--output=map.yaml,points.ply\n"
    "  plumbline_convert --input=graph.g2o --output=graph.toro,graph.tum\n\n"
    "What a format holds:\n"
    "  tum      poses and times; a vertex without a scan has its index as its time\n"
    "  g2o      poses, edges, fixed poses, scans as ROBOTLASER1 records with their times. From a\n"
    "           log: the edges are the odometry from scan to scan, their noise the motion model's\n"
    "           default; ODOM records in between are not kept. plumbline_slam looks for loops in\n"
    "           logs, not in pose graphs: --trajectory hands on what it found\n"
    "  toro     the same; other programs than Plumbline skip the fixed poses and the scans\n"
    "  ply      the measured ends of the beams at these poses, with the scan of each; doubles.\n"
    "           Lasers that sweep: each by the pose at its own time, see --sweep_time_s\n"
    "  pcd      the same in floats, for PCL\n"
    "  ros_map  .pgm and .yaml, an occupancy grid for ROS and Nav2\n"
    "g2o to TORO and back gives the same numbers, as they are written in the file. What a format\n"
    "has no place for is left out, with a line on standard error that counts it.";

// CheckFlags has found the list in order.
std::vector<std::string> OutputFiles(const std::string& output) {
  std::vector<ConversionTarget> targets;
  std::vector<std::string> files;
  if (!ParseConversionTargets(output, FLAGS_format, &targets).ok()) return files;
  for (const ConversionTarget& target : targets) {
    for (const std::string& file : target.Files()) files.push_back(file);
  }
  return files;
}

const std::vector<FileFlag>& FileFlags() {
  static const std::vector<FileFlag> flags = {
      {"input", &FLAGS_input, FileUse::kInput, LogFiles},
      {"trajectory", &FLAGS_trajectory, FileUse::kInput},
      {"output", &FLAGS_output, FileUse::kOutput, OutputFiles}};
  return flags;
}

Status OptionsFromFlags(ConvertOptions* options) {
  if (FLAGS_input.empty()) return Status::InvalidArgument("--input is missing; see --help");
  if (FLAGS_output.empty()) return Status::InvalidArgument("--output is missing; see --help");
  options->input = FLAGS_input;
  options->trajectory = FLAGS_trajectory;
  options->map_resolution_m = FLAGS_map_resolution_m;
  std::string error;
  if (!options->Check(&error)) return Status::InvalidArgument("ROS map: " + error);
  return ParseConversionTargets(FLAGS_output, FLAGS_format, &options->targets);
}

Status CheckFlags() {
  ConvertOptions options;
  return OptionsFromFlags(&options);
}

Status Run() {
  ConvertOptions options;
  PLUMBLINE_RETURN_IF_ERROR(OptionsFromFlags(&options));
  EndIfStoppedWhile("reading " + options.input);
  ConversionReport report;
  PLUMBLINE_RETURN_IF_ERROR(Convert(options, &report));
  std::cout << "Read " << Legible(options.input) << ": " << report.num_poses << " poses, "
            << report.num_edges << " edges, " << report.num_scans << " scans, "
            << report.num_returns << " returns, " << report.counts.num_skipped_records
            << " records skipped\n";
  if (report.sweep_order) {
    std::cout << "Sweeps: measured " << ToString(*report.sweep_order)
              << ", by what the scans say\n";
  }
  for (std::size_t i = 0; i < options.targets.size(); ++i) {
    const ConversionTarget& target = options.targets[i];
    std::cout << "Wrote";
    for (const std::string& file : target.Files()) std::cout << ' ' << Legible(file);
    std::cout << " (" << ToString(target.format) << ")\n" << std::flush;
    if (report.left_out[i].empty()) continue;
    std::cerr << Legible(target.path) << ": left out " << report.left_out[i] << "; "
              << ToString(target.format) << " has no place for them\n";
  }
  return Status::Ok();
}

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) {
  plumbline::StartProgram(plumbline::kUsage, argc, argv);
  return plumbline::RunProgram(plumbline::FileFlags(), plumbline::CheckFlags, plumbline::Run);
}
