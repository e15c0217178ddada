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
  Fields<MotionOptions>(module, "MotionOptions",
                        "Noise of the odometry: standard deviations that grow with what was "
                        "driven, plus a floor.")
      .Options()
      .Option("rotation_per_rotation", &MotionOptions::rotation_per_rotation, "[rad per rad]")
      .Option("rotation_per_translation_rad_m", &MotionOptions::rotation_per_translation_rad_m,
              "[rad per m]")
      .Option("translation_per_translation", &MotionOptions::translation_per_translation,
              "[m per m]")
      .Option("translation_per_rotation_m_rad", &MotionOptions::translation_per_rotation_m_rad,
              "[m per rad]")
      .Option("translation_floor_m", &MotionOptions::translation_floor_m, "at standstill [m]")
      .Option("rotation_floor_rad", &MotionOptions::rotation_floor_rad, "at standstill [rad]");
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
  Fields<ShapeOptions>(module, "ShapeOptions",
                       "How exactly adjacent surfaces are parallel or orthogonal.")
      .Options()
      .Option("enabled", &ShapeOptions::enabled, "whether there is such a term at all")
      .Option("sigma_rad", &ShapeOptions::sigma_rad, "of a normal from its direction [rad]")
      .Option("robust_gate_sigmas", &ShapeOptions::robust_gate_sigmas,
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
      .Option("shape", &FactorOptions::shape, "surfaces are parallel or orthogonal")
      .Option("downweighted_steps", &FactorOptions::downweighted_steps,
              "where the motion model does not hold")
      .Option("ignored_relative_poses", &FactorOptions::ignored_relative_poses,
              "relative poses that are known to be wrong: indices into SlamGraph.relative_poses");
}

void BindMinimiserOptions(py::module_* module) {
  Fields<AssociationOptions>(module, "AssociationOptions", "Which returns share a surface.")
      .Options()
      .Option("neighborhood", &AssociationOptions::neighborhood,
              "how the neighbourhood of a tangent line is chosen")
      .Option("min_points", &AssociationOptions::min_points,
              "fewest points that make a tangent line")
      .Option("several_poses", &AssociationOptions::several_poses,
              "a line of single points needs those of more than one pose")
      .Option("landmark_size_m", &AssociationOptions::landmark_size_m,
              "reduced solver: side of the largest cell that may be one landmark [m]")
      .Option("max_points", &AssociationOptions::max_points,
              "NEAREST only: most points of a neighbourhood")
      .Option("max_eigenvalue_ratio", &AssociationOptions::max_eigenvalue_ratio,
              "line-like up to this ratio of the smaller to the larger variance")
      .Option("min_segment_length_m", &AssociationOptions::min_segment_length_m,
              "shape pairs: length of the surface regions along a scan [m]")
      .Option("shape_margin_rad", &AssociationOptions::shape_margin_rad,
              "shape pairs: regions this close to parallel or orthogonal pair up [rad]");
  Fields<RoundOptions>(module, "RoundOptions", "The rounds of solvers over points.")
      .Options()
      .Option("max_coarse_rounds", &RoundOptions::max_coarse_rounds, "may be 0")
      .Option("max_fine_rounds", &RoundOptions::max_fine_rounds, "at least 1")
      .Option("coarse_radius_m", &RoundOptions::coarse_radius_m,
              "smallest neighbourhood radius of the first coarse round [m]")
      .Option("fine_radius_m", &RoundOptions::fine_radius_m,
              "smallest neighbourhood radius of the fine rounds [m]")
      .Option("coarse_gate_factor", &RoundOptions::coarse_gate_factor,
              "on the robust gates of the map terms in the first coarse round; falls to 1")
      .Option("relative_tolerance", &RoundOptions::relative_tolerance,
              "fine rounds end when one lowers the marginal energy by less than this fraction");
  Fields<ReducedOptions>(module, "ReducedOptions", "The reduced solver, the default.")
      .Options()
      .Option("max_rounds", &ReducedOptions::max_rounds, "each cuts the surfaces anew")
      .Option("steps_per_round", &ReducedOptions::steps_per_round, "of Gauss-Newton, at most")
      .Option("first_gate_factor", &ReducedOptions::first_gate_factor,
              "on the robust gate of the manifold term in the first round")
      .Option("relative_tolerance", &ReducedOptions::relative_tolerance,
              "rounds end when the last step lowers the cost by less than this fraction, and")
      .Option("move_tolerance_sigmas", &ReducedOptions::move_tolerance_sigmas,
              "moves returns across their surfaces by less than this")
      .Option("lines_follow", &ReducedOptions::lines_follow,
              "the lines are refitted exactly after each step")
      .Option("cg_tolerance", &ReducedOptions::cg_tolerance,
              "conjugate gradients end at this fraction of the right-hand side");
  Fields<AlternatingCgOptions>(module, "AlternatingCgOptions", "Alternating conjugate gradients.")
      .Options()
      .Option("max_sweeps", &AlternatingCgOptions::max_sweeps,
              "each moves the map, then the poses, then scans with their points")
      .Option("map_iterations_per_sweep", &AlternatingCgOptions::map_iterations_per_sweep,
              "of the first part")
      .Option("pose_iterations_per_sweep", &AlternatingCgOptions::pose_iterations_per_sweep,
              "of the second part")
      .Option("scan_iterations_per_sweep", &AlternatingCgOptions::scan_iterations_per_sweep,
              "of the third part; 0: without it")
      .Option("relative_cost_tolerance", &AlternatingCgOptions::relative_cost_tolerance,
              "ends when a sweep lowers the cost by less than this fraction");
  Fields<PublishedOptions>(module, "PublishedOptions", "The method as it was published.")
      .Options()
      .Option("max_passes", &PublishedOptions::max_passes,
              "each finds the tangent lines and shape pairs anew")
      .Option("sweeps_per_pass", &PublishedOptions::sweeps_per_pass,
              "iterations on the map, and as many on the poses, per pass")
      .Option("relative_tolerance", &PublishedOptions::relative_tolerance,
              "ends when a pass lowers the energy by less than this fraction")
      .Option("sigma_from_start", &PublishedOptions::sigma_from_start,
              "thickness of surfaces from the start's distances to its tangent lines")
      .Option("precondition", &PublishedOptions::precondition,
              "by diagonal blocks of the Gauss-Newton Hessian");
  Fields<StochasticDescentOptions>(module, "StochasticDescentOptions",
                                   "Stochastic gradient descent on a pose graph.")
      .Options()
      .Option("max_iterations", &StochasticDescentOptions::max_iterations,
              "each goes through all edges once");
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
      .Option("sgd", &SolverOptions::sgd, "SGD")
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
  Fields<SequentialSeedingOptions>(module, "SequentialSeedingOptions",
                                   "Each scan is matched against a local map of keyframes.")
      .Options()
      .Option("keyframe_distance_m", &SequentialSeedingOptions::keyframe_distance_m,
              "a scan this far from all keyframes becomes one [m]")
      .Option("keyframe_angle_rad", &SequentialSeedingOptions::keyframe_angle_rad,
              "or turned by this much [rad]");
  Fields<SeedingOptions>(module, "SeedingOptions", "How a seed is found.")
      .Options()
      .Option("sequential", &SeedingOptions::sequential, "scan matching");
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
  py::enum_<NeighborhoodType>(*module, "NeighborhoodType", "Neighbourhoods of tangent lines.")
      .value("RADIUS", NeighborhoodType::kRadius, "all points within a radius")
      .value("NEAREST", NeighborhoodType::kNearest, "the published form: nearest points");
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
