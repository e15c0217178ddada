#include "plumbline/apps/evaluation/evaluation.h"

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

#include "plumbline/apps/evaluation/log_map.h"
#include "plumbline/apps/io/clock.h"
#include "plumbline/apps/io/ply_reader.h"
#include "plumbline/apps/io/pose_timeline.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"

namespace plumbline {
namespace {

Status EvaluateRelations(const EvaluationInputs& inputs, const std::vector<TimedPose>& trajectory,
                         Evaluation* evaluation) {
  std::vector<Relation> relations;
  PLUMBLINE_RETURN_IF_ERROR(ReadRelations(inputs.relations, &relations));
  const std::string fault = ClockFault(TimesOf(trajectory));
  if (!fault.empty()) {
    return Status::InvalidArgument(inputs.trajectory + ": " + fault +
                                   ": relations find their poses by time");
  }
  if (std::all_of(relations.begin(), relations.end(),
                  [](const Relation& relation) { return relation.from_s == relation.to_s; })) {
    return Status::InvalidArgument(inputs.relations +
                                   ": its clock is useless: no relation has two different times");
  }
  evaluation->relations = MeasureRelations(relations, trajectory, inputs.relations_options);
  if (evaluation->relations->all.num_matched > 0) return Status::Ok();
  return Status::InvalidArgument(inputs.relations + ": no relation's times are those of " +
                                 inputs.trajectory);
}

Status EvaluateTrajectory(const EvaluationInputs& inputs, const std::vector<TimedPose>& trajectory,
                          Evaluation* evaluation) {
  std::vector<TimedPose> truth;
  PLUMBLINE_RETURN_IF_ERROR(ReadTumTrajectory(inputs.truth, &truth));
  const double tolerance_s = std::min(kSameTime_s, inputs.trajectory_options.max_time_difference_s);
  Pairing pairing;
  PLUMBLINE_RETURN_IF_ERROR(ChoosePairing({inputs.truth, TimesOf(truth)},
                                          {inputs.trajectory, TimesOf(trajectory)}, tolerance_s,
                                          &pairing));
  evaluation->truth_by_order = pairing.clock_is_useless;
  evaluation->trajectory = MeasureTrajectory(trajectory, truth, inputs.trajectory_options, pairing);
  if (evaluation->trajectory->absolute.num_matched > 0) return Status::Ok();
  return Status::InvalidArgument(inputs.truth + ": no pose's time is one of " + inputs.trajectory);
}

Status EvaluateLog(const EvaluationInputs& inputs, const std::vector<TimedPose>& trajectory,
                   ThreadPool* pool, Evaluation* evaluation) {
  LogAtPoses map;
  PLUMBLINE_RETURN_IF_ERROR(ReadLogMap(inputs.log, inputs.trajectory, trajectory, &map));
  const MapState state = map.graph.InitialState();
  evaluation->raw_ranges = MeasureSharpness(state.points, pool);
  evaluation->consistency = MeasureMapConsistency(map.graph, PosesOf(state.poses), pool);
  evaluation->num_scans_without_pose = map.num_scans_without_pose;
  evaluation->log_by_order = map.clock_is_useless;
  return Status::Ok();
}

}  // namespace

Status CheckInputs(const EvaluationInputs& inputs) {
  const bool needs_trajectory =
      !inputs.relations.empty() || !inputs.truth.empty() || !inputs.log.empty();
  if (!needs_trajectory && inputs.points.empty()) {
    return Status::InvalidArgument(
        "nothing to measure: give --relations, --truth, --log or --points; see --help");
  }
  if (needs_trajectory && inputs.trajectory.empty()) {
    return Status::InvalidArgument("--trajectory is missing; see --help");
  }
  std::string error;
  if (!inputs.relations_options.Check(&error) || !inputs.trajectory_options.Check(&error)) {
    return Status::InvalidArgument(error);
  }
  return Status::Ok();
}

Status Evaluate(const EvaluationInputs& inputs, Evaluation* evaluation) {
  PLUMBLINE_RETURN_IF_ERROR(CheckInputs(inputs));
  Evaluation result;
  std::vector<TimedPose> trajectory;
  if (!inputs.trajectory.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(ReadTumTrajectory(inputs.trajectory, &trajectory));
  }
  if (!inputs.relations.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(EvaluateRelations(inputs, trajectory, &result));
  }
  if (!inputs.truth.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(EvaluateTrajectory(inputs, trajectory, &result));
  }
  ThreadPool pool(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  if (!inputs.log.empty()) {
    PLUMBLINE_RETURN_IF_ERROR(EvaluateLog(inputs, trajectory, &pool, &result));
  }
  if (!inputs.points.empty()) {
    std::vector<double> points;
    PLUMBLINE_RETURN_IF_ERROR(ReadPointsPly(inputs.points, &points));
    result.points = MeasureSharpness(points, &pool);
  }
  *evaluation = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
