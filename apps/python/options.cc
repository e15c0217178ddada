// All options, with the names and defaults of the library.

#include <string>

#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/fields.h"
#include "plumbline/solvers/calibration.h"
#include "plumbline/solvers/incremental_solver.h"
#include "plumbline/solvers/interface/ceres_options.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/solver_options.h"
#include "plumbline/solvers/map_log.h"
#include "plumbline/solvers/sliding_window.h"

namespace plumbline {
namespace py = pybind11;
namespace {

void BindFactorOptions(py::module_* module) {
  Fields<MotionOptions> motion(module, "MotionOptions",
                               "Noise of the odometry: standard deviations that grow with what was "
                               "driven, plus a floor.");
  motion.Options();
  for (const MotionField& field : kMotionFields) motion.Option(field.name, field.value, field.unit);
  Fields<RangeBeamOptions>(module, "RangeBeamOptions", "Noise of a single laser beam.")
      .Options()
      .Option("sigma_range_m", &RangeBeamOptions::sigma_range_m, "along the beam [m]")
      .Option("sigma_bearing_rad", &RangeBeamOptions::sigma_bearing_rad,
              "across the beam, its divergence included [rad]");
  Fields<ManifoldOptions>(module, "ManifoldOptions",
                          "How far a point may lie from its tangent line.")
      .Options()
      .Option("sigma_m", &ManifoldOptions::sigma_m, "thickness of a surface [m]")
      .Option("robust_gate_sigmas", &ManifoldOptions::robust_gate_sigmas,
              "Geman-McClure scale, in standard deviations; infinity: Gaussian");
  Fields<DownweightedStep>(module, "DownweightedStep",
                           "A step of the odometry that is known to be worse than the others.")
      .Options()
      .Option("step", &DownweightedStep::step, "index into SlamGraph.odometry")
      .Option("sigma_factor", &DownweightedStep::sigma_factor,
              "all its standard deviations are this times the model's");
  Fields<FactorOptions>(module, "FactorOptions", "All sigmas and gates of the energy.")
      .Options()
      .Option("motion", &FactorOptions::motion, "odometry")
      .Option("beam", &FactorOptions::beam, "the laser")
      .Option("manifold", &FactorOptions::manifold, "surfaces are thin")
      .Option("shape", &FactorOptions::shape,
              "whether adjacent surfaces are drawn to parallel or orthogonal")
      .Option("downweighted_steps", &FactorOptions::downweighted_steps,
              "where the motion model does not hold")
      .Option("ignored_relative_poses", &FactorOptions::ignored_relative_poses,
              "relative poses that are known to be wrong: indices into SlamGraph.relative_poses");
}

void BindMinimiserOptions(py::module_* module) {
  Fields<AssociationOptions>(module, "AssociationOptions", "Which returns share a surface.")
      .Options()
      .Option("several_poses", &AssociationOptions::several_poses,
              "a line of single points needs those of more than one pose")
      .Option("landmark_size_m", &AssociationOptions::landmark_size_m,
              "side of the largest cell that may be one landmark [m]");
  Fields<RoundOptions>(module, "RoundOptions", "The rounds of solvers over points.")
      .Options()
      .Option("max_coarse_rounds", &RoundOptions::max_coarse_rounds, "may be 0")
      .Option("max_fine_rounds", &RoundOptions::max_fine_rounds, "at least 1")
      .Option("coarse_radius_m", &RoundOptions::coarse_radius_m,
              "smallest neighbourhood radius of the first coarse round [m]")
      .Option("fine_radius_m", &RoundOptions::fine_radius_m,
              "smallest neighbourhood radius of the fine rounds [m]");
  Fields<ReducedOptions>(module, "ReducedOptions", "The reduced solver, the default.")
      .Options()
      .Option("max_rounds", &ReducedOptions::max_rounds, "each cuts the surfaces anew")
      .Option("relative_tolerance", &ReducedOptions::relative_tolerance,
              "rounds end when the last step lowers the cost by less than this fraction, and the "
              "round hardly moves the returns")
      .Option("lines_follow", &ReducedOptions::lines_follow,
              "the lines are refitted exactly after each step");
  Fields<AlternatingCgOptions>(module, "AlternatingCgOptions", "Alternating conjugate gradients.")
      .Options()
      .Option("max_sweeps", &AlternatingCgOptions::max_sweeps,
              "each moves the map, then the poses, then scans with their points")
      .Option("scan_iterations_per_sweep", &AlternatingCgOptions::scan_iterations_per_sweep,
              "iterations of the third part; 0: without it")
      .Option("relative_cost_tolerance", &AlternatingCgOptions::relative_cost_tolerance,
              "ends when a sweep lowers the cost by less than this fraction");
  Fields<PublishedOptions>(module, "PublishedOptions", "The method as it was published.")
      .Options()
      .Option("max_passes", &PublishedOptions::max_passes,
              "each finds the tangent lines and shape pairs anew")
      .Option("sigma_from_start", &PublishedOptions::sigma_from_start,
              "thickness of surfaces from the start's distances to its tangent lines");
}

// The options of Ceres by Ceres' names; read only, so that nobody changes a copy in vain.
py::object CeresFieldsOf(const SolverOptions& options) {
  py::dict fields;
  for (const CeresField& field : CeresFields()) fields[field.name] = field.get(*options.ceres);
  return py::module_::import("types").attr("MappingProxyType")(fields);
}

// Sets the named fields; the others get their defaults.
void SetCeresFields(SolverOptions* options, const py::dict& fields) {
  CeresOptions ceres;
  ceres.reduced = options->ceres->reduced;
  for (const auto& [name, value] : fields) {
    const Status status = SetCeresField(py::str(name), py::str(value), &ceres);
    if (!status.ok()) RaiseIfError(Status::InvalidArgument("ceres: " + status.message()));
  }
  *options->ceres = ceres;
}

void BindSolverOptions(py::module_* module) {
  Fields<SolverOptions>(module, "SolverOptions",
                        "What solve goes by. The defaults suit buildings and a laser of the SICK "
                        "class: set the noise of your own in factors.beam.")
      .Options()
      .Option("type", &SolverOptions::type, "the minimiser")
      .Option("factors", &SolverOptions::factors, "noise and gates of every term")
      .Option("test_edges", &SolverOptions::test_edges,
              "whether relative poses that their scans contradict are ignored")
      .Option("association", &SolverOptions::association, "which returns share a surface")
      .Option("rounds", &SolverOptions::rounds, "ALTERNATING_CG, and CERES over points")
      .Option("reduced", &SolverOptions::reduced, "REDUCED, and CERES over landmarks")
      .Option("alternating_cg", &SolverOptions::alternating_cg, "ALTERNATING_CG")
      .Option("published", &SolverOptions::published, "PUBLISHED")
      .OptionOf(
          "ceres", CeresFieldsOf,
          [](SolverOptions& options, const py::object& fields) {
            SetCeresFields(&options, py::dict(fields));
          },
          "CERES: fields of ceres::Solver::Options by Ceres' names, {'linear_solver_type': "
          "'SPARSE_SCHUR'}; those that are not named get their defaults")
      .OptionBy(
          "ceres_reduced", [](SolverOptions& options) -> bool& { return options.ceres->reduced; },
          "CERES: over the lines of landmarks, points eliminated")
      .Option("num_threads", &SolverOptions::num_threads,
              "the calling one included; results do not depend on it, but for CERES")
      .Option("measure_rounds", &SolverOptions::measure_rounds,
              "whether to fill in SolverSummary.round_energies, which takes as long as finding the "
              "lines of every return once per round");
  Fields<WindowOptions>(module, "WindowOptions",
                        "What of a growing graph solve_window refines at a time.")
      .Options()
      .Option("num_free_poses", &WindowOptions::num_free_poses, "the newest poses that may move")
      .Option("max_fixed_poses", &WindowOptions::max_fixed_poses,
              "older poses that hold the map around them, at most");
  Fields<IncrementalOptions>(module, "IncrementalOptions",
                             "How IncrementalSolver refines a graph while it grows.")
      .Options()
      .Option("num_free_poses", &IncrementalOptions::num_free_poses,
              "the newest poses that an update moves; all new ones in any case")
      .Option("max_rounds", &IncrementalOptions::max_rounds,
              "cuts of the surfaces into landmarks per update, at most");
  Fields<CalibrationOptions>(module, "CalibrationOptions",
                             "What of the sensors is estimated along with poses and points.")
      .Options()
      .Option("laser_mounting", &CalibrationOptions::laser_mounting,
              "robot_from_laser: x, y [m], yaw [rad]")
      .Option("range_bias", &CalibrationOptions::range_bias, "one length on all readings [m]")
      .Option("range_scale", &CalibrationOptions::range_scale, "one factor on all ranges")
      .Option("odometry_scale", &CalibrationOptions::odometry_scale,
              "one factor on all lengths that the odometry reads");
}

void BindLogOptions(py::module_* module) {
  Fields<SeedingOptions>(module, "SeedingOptions", "How a seed is found.")
      .Options()
      .Option("keyframe_distance_m", &SeedingOptions::keyframe_distance_m,
              "scan matching: a scan this far from all keyframes becomes one [m]");
  Fields<MapLogOptions>(module, "MapLogOptions", "How a log is mapped.")
      .Options()
      .Option("start", &MapLogOptions::start, "where the joint estimation starts")
      .Option("seeding", &MapLogOptions::seeding, "how the seed is found")
      .Option("solver", &MapLogOptions::solver, "the joint estimation, and the sensors' noise")
      .Option("calibration", &MapLogOptions::calibration, "what of the sensors to estimate");
}

void BindChoices(py::module_* module) {
  py::enum_<SolverType>(*module, "SolverType", "The solvers of the library.")
      .value("REDUCED", SolverType::kReduced, "points and lines eliminated; Gauss-Newton")
      .value("ALTERNATING_CG", SolverType::kAlternatingCg, "conjugate gradients")
      .value("PUBLISHED", SolverType::kPublished, "the method as published")
      .value("CERES", SolverType::kCeres, "one problem of Ceres")
      .value("POSE_GRAPH", SolverType::kPoseGraph, "poses by relative poses alone")
      .value("SGD", SolverType::kSgd, "likewise, by stochastic gradient descent");
  py::enum_<UpdateScope>(*module, "UpdateScope", "Which poses an update may move.")
      .value("AUTOMATIC", UpdateScope::kAutomatic,
             "the newest ones; all of them if older ones were moved, or a loop closure asks for it")
      .value("ALL", UpdateScope::kAll, "all poses");
  py::enum_<StartType>(*module, "StartType", "Where the joint estimation starts.")
      .value("ODOMETRY", StartType::kOdometry, "the odometry as it is")
      .value("ICP", StartType::kIcp, "each scan matched to the one before, point to point")
      .value("ICP_POINT_TO_LINE", StartType::kIcpPointToLine, "likewise, point to line")
      .value("ICP_GLOBAL", StartType::kIcpGlobal,
             "after that all scans that see the same place, jointly")
      .value("SEED", StartType::kSeed, "matching against local maps, and loop closure");
  py::enum_<SeedingPhase>(*module, "SeedingPhase", "What the seeding is at.")
      .value("MATCHING_SCANS", SeedingPhase::kMatchingScans)
      .value("CLOSING_LOOPS", SeedingPhase::kClosingLoops)
      .value("TYING_SESSIONS", SeedingPhase::kTyingSessions);
}

}  // namespace

void BindOptions(py::module_* module) {
  BindChoices(module);
  BindFactorOptions(module);
  BindMinimiserOptions(module);
  BindSolverOptions(module);
  BindLogOptions(module);
}

}  // namespace plumbline
