// Seeding, solving, residuals and covariances.

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "plumbline/apps/python/arrays.h"
#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/errors.h"
#include "plumbline/apps/python/fields.h"
#include "plumbline/apps/python/objects.h"
#include "plumbline/apps/python/progress.h"
#include "plumbline/core/measured_surface.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/solvers/association/noise_scales.h"
#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/covariance.h"
#include "plumbline/solvers/refine_state.h"
#include "plumbline/solvers/seed.h"
#include "plumbline/solvers/sliding_window.h"
#include "plumbline/solvers/solve.h"

namespace plumbline {
namespace py = pybind11;
namespace {

// Calls solve(options, graph, state) on copies, without Python's lock, and writes the result into
// the state, also where something was raised on the way: the solver has then stopped with the best.
template <typename SolveCall>
SolverSummary SolveInPlace(const GraphObject& graph, StateObject& object, SolverOptions options,
                           py::object callback, const SolveCall& solve) {
  Progress progress(std::move(callback));
  options.callback = progress.OfSolver();
  MapState state = object.WritableStateOf(*graph);
  SolverSummary summary = graph.ReadUnlocked(
      [&](const SlamGraph& unlocked) { return solve(options, unlocked, &state); });
  if (summary.IsSolutionUsable()) object.Write(std::move(state));
  progress.RaisePending();
  RaiseIfFailed(summary);
  return summary;
}

SolverSummary SolveGraph(const GraphObject& graph, StateObject& state, const SolverOptions& options,
                         py::object progress) {
  return SolveInPlace(
      graph, state, options, std::move(progress),
      [](const auto& o, const SlamGraph& g, MapState* s) { return RefineState(o, g, s); });
}

SolverSummary SolveNewest(const GraphObject& graph, StateObject& state, const WindowOptions& window,
                          const SolverOptions& options, py::object progress) {
  return SolveInPlace(
      graph, state, options, std::move(progress),
      [&](const auto& o, const SlamGraph& g, MapState* s) { return SolveWindow(o, window, g, s); });
}

SolverSummary SolveChosen(const GraphObject& graph, StateObject& state,
                          const std::vector<int>& free_poses, const WindowOptions& window,
                          const SolverOptions& options, py::object progress) {
  for (const int pose : free_poses) CheckId("pose", pose, graph->num_poses());
  return SolveInPlace(graph, state, options, std::move(progress),
                      [&](const auto& o, const SlamGraph& g, MapState* s) {
                        return SolvePoses(o, window, free_poses, g, s);
                      });
}

std::pair<SolverSummary, Calibration> SolveCalibrated(const GraphObject& graph, StateObject& state,
                                                      const CalibrationOptions& calibration,
                                                      const SolverOptions& options,
                                                      py::object progress) {
  Calibration found;
  SolverSummary summary = SolveInPlace(graph, state, options, std::move(progress),
                                       [&](const auto& o, const SlamGraph& g, MapState* s) {
                                         return SolveWithCalibration(o, calibration, g, s, &found);
                                       });
  return {std::move(summary), std::move(found)};
}

std::pair<StateObject, SeedingReport> Seed(const GraphObject& graph, const SeedingOptions& seeding,
                                           const SolverOptions& options, py::object callback) {
  CheckOptions(options);
  Progress progress(std::move(callback));
  MapState state;
  SeedingReport report;
  const Status status = graph.ReadUnlocked([&](const SlamGraph& unlocked) {
    ThreadPool pool(options.num_threads);
    const FactorOptions& factors = options.factors;
    return SeedGraph(seeding, factors.motion,
                     MeasureSurface(unlocked, NormalOptionsFor(factors.beam), &pool),
                     progress.OfSeeding(), &pool, unlocked, &state, &report);
  });
  progress.RaisePending();
  RaiseIfError(status);
  return {StateObject(std::move(state)), std::move(report)};
}

// Row by row.
template <int N>
py::array_t<double> RowsOfVectors(const std::vector<Eigen::Matrix<double, N, 1>>& vectors) {
  std::vector<double> rows;
  rows.reserve(N * vectors.size());
  for (const auto& vector : vectors) rows.insert(rows.end(), vector.begin(), vector.end());
  return ArrayOf(std::move(rows), N);
}

Residuals Evaluate(const GraphObject& graph, const StateObject& object,
                   const SolverOptions& options) {
  const MapState state = object.StateOf(*graph);
  Residuals residuals;
  RaiseIfError(graph.ReadUnlocked([&](const SlamGraph& unlocked) {
    return EvaluateResiduals(options, unlocked, state, &residuals);
  }));
  return residuals;
}

py::array_t<double> Covariances(const GraphObject& graph, const StateObject& object,
                                const std::vector<std::pair<int, int>>& ids,
                                const SolverOptions& options) {
  const MapState state = object.StateOf(*graph);
  std::vector<PosePair> pairs;
  for (const auto& [a, b] : ids) {
    CheckId("pose", a, graph->num_poses());
    CheckId("pose", b, graph->num_poses());
    pairs.push_back({a, b});
  }
  std::vector<Eigen::Matrix3d> covariances;
  RaiseIfError(graph.ReadUnlocked([&](const SlamGraph& unlocked) {
    return ComputePoseCovariances(options, unlocked, state, pairs, &covariances);
  }));
  py::array_t<double> result(
      {static_cast<py::ssize_t>(pairs.size()), py::ssize_t{3}, py::ssize_t{3}});
  auto values = result.mutable_unchecked<3>();
  for (py::ssize_t i = 0; i < values.shape(0); ++i) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        values(i, row, column) = covariances[i](row, column);
      }
    }
  }
  return result;
}

Eigen::Matrix3d CovarianceOfMotion(const Pose2& world_from_a, const Pose2& world_from_b,
                                   const py::object& aa, const py::object& ab,
                                   const py::object& bb) {
  return RelativePoseCovariance(world_from_a, world_from_b, MatrixOf("aa", aa), MatrixOf("ab", ab),
                                MatrixOf("bb", bb));
}

void BindSolves(py::module_* module) {
  const auto options = py::arg_v("options", SolverOptions(), "SolverOptions()");
  const auto window = py::arg_v("window", WindowOptions(), "WindowOptions()");
  const auto progress = py::arg("progress") = py::none();
  module->def("solve", &SolveGraph, py::arg("graph"), py::arg("state"), options, progress,
              "Estimates all poses and all map points jointly, starting from the state, which "
              "should be right to a few decimetres (seed_graph brings it there). The result is "
              "written into the arrays of the state; it is never worse by what the returns say.\n\n"
              "progress(IterationSummary) is called after each iteration; False stops with the "
              "best state. What it raises, and Ctrl-C, does the same, and is raised once the state "
              "has been written. Python's lock is released meanwhile; the graph cannot change. "
              "Raises InvalidArgumentError, with the state unchanged, on bad input.");
  module->def("solve_window", &SolveNewest, py::arg("graph"), py::arg("state"), window, options,
              progress,
              "Refines the newest poses, and their points, against the map of older ones, which "
              "stay as they are: while driving. See solve.");
  module->def("solve_poses", &SolveChosen, py::arg("graph"), py::arg("state"),
              py::arg("free_poses"), window, options, progress,
              "The same for any set of poses, by their ids.");
  module->def("solve_with_calibration", &SolveCalibrated, py::arg("graph"), py::arg("state"),
              py::arg_v("calibration", CalibrationOptions(), "CalibrationOptions()"), options,
              progress,
              "solve, with parameters of the sensors as further unknowns: returns the summary and "
              "what was found of them. SlamGraph.corrected applies it to a graph.");
  module->def("seed_graph", &Seed, py::arg("graph"),
              py::arg_v("seeding", SeedingOptions(), "SeedingOptions()"), options, progress,
              "Finds where scan matching, loop closure and a pose graph put every pose: returns a "
              "MapState and a SeedingReport. Poses are in order of time, joined by odometry from "
              "each to the next, or by none at all. progress(phase, num_done, num_total) may "
              "return False, which raises UnavailableError.");
}

void BindAnalysis(py::module_* module) {
  const auto options = py::arg_v("options", SolverOptions(), "SolverOptions()");
  Fields<Residuals>(module, "Residuals",
                    "What every term says against a state, in standard deviations.")
      .FieldBy(
          "odometry", [](const Residuals& r) { return RowsOfVectors<3>(r.odometry); },
          "(K, 3): per constraint; 99.9 % of sound ones have a sum of squares below 16.3")
      .FieldBy(
          "relative_poses", [](const Residuals& r) { return RowsOfVectors<3>(r.relative_poses); },
          "(L, 3): see odometry")
      .FieldBy(
          "beams", [](const Residuals& r) { return RowsOfVectors<2>(r.beams); },
          "(M, 2): per return, range and bearing of its map point against the reading")
      .FieldBy(
          "surfaces", [](const Residuals& r) { return ArrayOf(r.surfaces); },
          "(M,): per return, distance from the tangent line; NaN: it has none");
  module->def("evaluate_residuals", &Evaluate, py::arg("graph"), py::arg("state"), options,
              "Evaluates the terms at a state, under the tangent lines that its poses give.");
  module->def("compute_pose_covariances", &Covariances, py::arg("graph"), py::arg("state"),
              py::arg("pairs"), options,
              "(K, 3, 3): for each pair of pose ids (a, b) the covariance of their errors, rows of "
              "a, columns of b: x, y [m], yaw [rad], world axes. (a, a) is the marginal of a.");
  module->def("relative_pose_covariance", &CovarianceOfMotion, py::arg("world_from_a"),
              py::arg("world_from_b"), py::arg("aa"), py::arg("ab"), py::arg("bb"),
              "(3, 3): of the motion from a to b, in the axes of a, from the covariances of "
              "compute_pose_covariances for (a, a), (a, b) and (b, b).");
}

}  // namespace

void BindSolvers(py::module_* module) {
  BindSolves(module);
  BindAnalysis(module);
}

}  // namespace plumbline
