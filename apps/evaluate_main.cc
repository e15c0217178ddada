// A trajectory or a map in; how accurate and how sharp it is out.

#include <gflags/gflags.h>

#include <iostream>
#include <string>
#include <vector>

#include "plumbline/apps/evaluation/evaluation.h"
#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/program/read_log.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/report/evaluation_report.h"

namespace {

// The library's defaults are those of the flags.
const plumbline::EvaluationInputs& Defaults() {
  static const plumbline::EvaluationInputs inputs;
  return inputs;
}

}  // namespace

DEFINE_string(trajectory, "", "Trajectory to measure (TUM: 't x y z qx qy qz qw')");
DEFINE_string(relations, "",
              "True relative poses ('t1 t2 x y z roll pitch yaw'): relations metric");
DEFINE_string(truth, "", "True trajectory (TUM): absolute and relative error, as evo has them");
DEFINE_string(log, "",
              "CARMEN log, plain or .gz, or bag of ROS 1 or ROS 2: sharpness of its ranges at the "
              "trajectory's "
              "poses, and whether "
              "its passes contradict each other about free space");
DEFINE_string(points, "", "Map points (PLY of plumbline_slam): their sharpness");
DEFINE_string(json, "", "Write the figures to this file as JSON");
DEFINE_string(csv, "", "Write the figures to this file as lines 'figure,value'");

DEFINE_double(relations_tolerance_s, Defaults().relations_options.tolerance_s,
              "A pose stands for a relation's time within this time [s]");
DEFINE_double(local_span_s, Defaults().relations_options.local_span_s,
              "Relations that span no more time are local, the others revisits [s]");
DEFINE_double(max_time_difference_s, Defaults().trajectory_options.max_time_difference_s,
              "Poses of trajectory and truth are a pair up to this difference in time [s]");
DEFINE_int32(rpe_delta_frames, Defaults().trajectory_options.delta_frames,
             "Step of the relative error [pairs of poses]");
DEFINE_double(rpe_delta_m, Defaults().trajectory_options.delta_m,
              "Step of the relative error by length of path [m]");

namespace plumbline {
namespace {

const std::vector<FileFlag>& FileFlags() {
  static const std::vector<FileFlag> flags = {{"trajectory", &FLAGS_trajectory, FileUse::kInput},
                                              {"relations", &FLAGS_relations, FileUse::kInput},
                                              {"truth", &FLAGS_truth, FileUse::kInput},
                                              {"log", &FLAGS_log, FileUse::kInput, LogFiles},
                                              {"points", &FLAGS_points, FileUse::kInput},
                                              {"json", &FLAGS_json, FileUse::kOutput},
                                              {"csv", &FLAGS_csv, FileUse::kOutput}};
  return flags;
}

EvaluationInputs InputsFromFlags() {
  EvaluationInputs inputs;
  inputs.trajectory = FLAGS_trajectory;
  inputs.relations = FLAGS_relations;
  inputs.truth = FLAGS_truth;
  inputs.log = FLAGS_log;
  inputs.points = FLAGS_points;
  inputs.relations_options.tolerance_s = FLAGS_relations_tolerance_s;
  inputs.relations_options.local_span_s = FLAGS_local_span_s;
  inputs.trajectory_options.max_time_difference_s = FLAGS_max_time_difference_s;
  inputs.trajectory_options.delta_frames = FLAGS_rpe_delta_frames;
  inputs.trajectory_options.delta_m = FLAGS_rpe_delta_m;
  return inputs;
}

Status CheckFlags() { return CheckInputs(InputsFromFlags()); }

Status Run() {
  EndIfStoppedWhile("measuring");
  Evaluation evaluation;
  PLUMBLINE_RETURN_IF_ERROR(Evaluate(InputsFromFlags(), &evaluation));
  EndIfStoppedWhileWriting();
  if (!FLAGS_json.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteEvaluationJson(FLAGS_json, evaluation));
  if (!FLAGS_csv.empty()) PLUMBLINE_RETURN_IF_ERROR(WriteEvaluationCsv(FLAGS_csv, evaluation));
  std::cout << EvaluationTables(evaluation);
  return Status::Ok();
}

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) {
  plumbline::StartProgram(
      "Measures a trajectory against true relative poses or a true trajectory, and the sharpness "
      "and consistency of maps.\n\n"
      "  plumbline_evaluate --trajectory=out/trajectory.tum --relations=fr079.relations\n"
      "  plumbline_evaluate --trajectory=out/trajectory.tum --truth=small_building.tum "
      "--log=small_building.clf --points=out/points.ply --json=figures.json",
      argc, argv);
  return plumbline::RunProgram(plumbline::FileFlags(), plumbline::CheckFlags, plumbline::Run);
}
