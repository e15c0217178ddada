// How good a trajectory or a map is.

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <utility>
#include <vector>

#include "plumbline/apps/evaluation/map_sharpness.h"
#include "plumbline/apps/evaluation/relations_metric.h"
#include "plumbline/apps/evaluation/trajectory_metrics.h"
#include "plumbline/apps/python/arrays.h"
#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/errors.h"
#include "plumbline/apps/python/fields.h"
#include "plumbline/apps/python/objects.h"
#include "plumbline/core/map_quality.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/loop_closure/consistency_meter.h"

namespace plumbline {
namespace py = pybind11;
namespace {

// As many threads as solvers take by default; no result depends on them.
int DefaultThreads() { return SolverOptions().num_threads; }

std::vector<Relation> ReadRelationsFile(const std::filesystem::path& path) {
  std::vector<Relation> relations;
  RaiseIfError(ReadRelations(path.string(), &relations));
  return relations;
}

RelationsMetric Relations(const std::vector<Relation>& relations, const py::object& timestamps_s,
                          const py::object& poses, const RelationsOptions& options) {
  CheckOptions(options);
  return MeasureRelations(relations, TrajectoryOf(timestamps_s, poses), options);
}

TrajectoryMetrics Trajectory(const py::object& timestamps_s, const py::object& poses,
                             const py::object& true_timestamps_s, const py::object& true_poses,
                             const TrajectoryMetricsOptions& options) {
  CheckOptions(options);
  return MeasureTrajectory(TrajectoryOf(timestamps_s, poses),
                           TrajectoryOf(true_timestamps_s, true_poses), options);
}

MapQuality Quality(const py::object& points, const MapQualityOptions& options) {
  CheckOptions(options);
  const std::vector<double> rows = RowsOf("points", points, 2);
  CheckReach("points", rows, 2);
  const py::gil_scoped_release unlocked;
  ThreadPool pool(DefaultThreads());
  return MeasureMapQuality(rows, options, &pool);
}

MapConsistency Consistency(const GraphObject& graph, const py::object& poses) {
  const std::vector<double> rows = PosesFor(*graph, poses);
  return graph.ReadUnlocked([&](const SlamGraph& unlocked) {
    ThreadPool pool(DefaultThreads());
    return MeasureMapConsistency(unlocked, PosesOf(rows), &pool);
  });
}

void BindTrajectoryMetrics(py::module_* module) {
  Fields<ErrorStatistics>(module, "ErrorStatistics", "Figures of errors; NaN if there are none.")
      .Field("mean", &ErrorStatistics::mean)
      .Field("std", &ErrorStatistics::std)
      .Field("rmse", &ErrorStatistics::rmse)
      .Field("median", &ErrorStatistics::median)
      .Field("p95", &ErrorStatistics::p95)
      .Field("max", &ErrorStatistics::max);
  Fields<PoseErrorStatistics>(module, "PoseErrorStatistics", "Figures of one metric.")
      .Field("num_matched", &PoseErrorStatistics::num_matched, "relations, poses or steps")
      .Field("num_unmatched", &PoseErrorStatistics::num_unmatched, "a pose of theirs is missing")
      .Field("translation_m", &PoseErrorStatistics::translation_m, "[m]")
      .Field("rotation_deg", &PoseErrorStatistics::rotation_deg, "[deg]");
  Fields<Relation>(module, "Relation", "A true relative pose of the robot between two times.")
      .Options()
      .Option("from_s", &Relation::from_s, "[s]")
      .Option("to_s", &Relation::to_s, "[s]")
      .Option("from_from_to", &Relation::from_from_to, "the pose at to_s seen from that at from_s");
  Fields<RelationsOptions>(module, "RelationsOptions", "How relations find their poses.")
      .Options()
      .Option("tolerance_s", &RelationsOptions::tolerance_s, "between a pose and a relation [s]")
      .Option("local_span_s", &RelationsOptions::local_span_s,
              "relations over no more than this are local, others revisits [s]");
  Fields<RelationsMetric>(module, "RelationsMetric", "Errors of relative poses.")
      .Field("all", &RelationsMetric::all)
      .Field("local", &RelationsMetric::local)
      .Field("revisits", &RelationsMetric::revisits);
  Fields<TrajectoryMetricsOptions>(module, "TrajectoryMetricsOptions", "How ATE and RPE are taken.")
      .Options()
      .Option("max_time_difference_s", &TrajectoryMetricsOptions::max_time_difference_s,
              "between poses of a pair [s]")
      .Option("delta_frames", &TrajectoryMetricsOptions::delta_frames, "step of the RPE, in pairs")
      .Option("delta_m", &TrajectoryMetricsOptions::delta_m, "step of the RPE along the path [m]");
  Fields<TrajectoryMetrics>(module, "TrajectoryMetrics", "Errors against a true trajectory.")
      .Field("absolute", &TrajectoryMetrics::absolute, "ATE, after the best rigid motion")
      .Field("relative_frames", &TrajectoryMetrics::relative_frames, "RPE over delta_frames")
      .Field("relative_metres", &TrajectoryMetrics::relative_metres, "RPE over delta_m");
  module->def("read_relations", &ReadRelationsFile, py::arg("path"),
              "Reads true relations of the Freiburg SLAM benchmark, plain or .gz.");
  module->def("measure_relations", &Relations, py::arg("relations"), py::arg("timestamps_s"),
              py::arg("poses"), py::arg_v("options", RelationsOptions(), "RelationsOptions()"),
              "The relations metric (Kuemmerle et al. 2009) of a trajectory: times [s], (N,), and "
              "poses, (N, 3).");
  module->def("measure_trajectory", &Trajectory, py::arg("timestamps_s"), py::arg("poses"),
              py::arg("true_timestamps_s"), py::arg("true_poses"),
              py::arg_v("options", TrajectoryMetricsOptions(), "TrajectoryMetricsOptions()"),
              "ATE and RPE, as the tool evo takes them.");
}

void BindMapMetrics(py::module_* module) {
  Fields<MapQualityOptions>(module, "MapQualityOptions", "How sharpness is measured.")
      .Options()
      .Option("radius_m", &MapQualityOptions::radius_m, "of the neighbourhoods [m]");
  Fields<MapQuality>(module, "MapQuality", "Sharpness of a point map; smaller is sharper.")
      .Field("wall_thickness_m", &MapQuality::wall_thickness_m, "median over the samples [m]")
      .Field("mean_map_entropy", &MapQuality::mean_map_entropy, "[nat]")
      .Field("num_samples", &MapQuality::num_samples, "neighbourhoods");
  module->def("measure_map_quality", &Quality, py::arg("points"),
              py::arg_v("options", MapQualityOptions(), "MapQualityOptions()"),
              "Sharpness of points, (M, 2) [m]. Compares maps of the same returns.");
  module->def("measure_map_consistency", &Consistency, py::arg("graph"), py::arg("poses"),
              "How well the scans of a graph, seen from these poses, (N, 3) and in order of time, "
              "agree on what is free space.");
}

}  // namespace

void BindEvaluation(py::module_* module) {
  BindTrajectoryMetrics(module);
  BindMapMetrics(module);
}

}  // namespace plumbline
