#include "plumbline/apps/flags.h"

#include <gflags/gflags.h>

#include <string>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/ceres_solver.h"

namespace {

// The library's defaults are those of the flags.
const plumbline::SolverOptions& Defaults() {
  static const plumbline::SolverOptions options;
  return options;
}
const plumbline::SeedingOptions& SeedingDefaults() {
  static const plumbline::SeedingOptions options;
  return options;
}

}  // namespace

DEFINE_string(
    solver, ToString(Defaults().type),
    "Minimiser of the joint energy: reduced, alternating_cg or ceres; or of the pose graph "
    "alone, points riding along: pose_graph (Gauss-Newton) or sgd");
DEFINE_int32(threads, Defaults().num_threads,
             "Threads; the result does not depend on it, but for the last digits of ceres");

// Sensor and surfaces.
DEFINE_double(sigma_range_m, Defaults().factors.beam.sigma_range_m,
              "Standard deviation of a range reading [m]");
DEFINE_double(sigma_bearing_rad, Defaults().factors.beam.sigma_bearing_rad,
              "Standard deviation of a beam's direction, its divergence included [rad]");
DEFINE_double(sigma_manifold_m, Defaults().factors.manifold.sigma_m,
              "Thickness of a surface: standard deviation of a point off its tangent line [m]");
DEFINE_double(manifold_gate, Defaults().factors.manifold.robust_gate_sigmas,
              "Robust gate of the manifold terms [standard deviations]");
DEFINE_bool(shape, Defaults().factors.shape.enabled,
            "Draw adjacent surfaces to parallel or orthogonal");
DEFINE_double(sigma_shape_rad, Defaults().factors.shape.sigma_rad,
              "Standard deviation of a surface's direction from its neighbour's [rad]");
DEFINE_double(shape_gate, Defaults().factors.shape.robust_gate_sigmas,
              "Robust gate of the shape terms [standard deviations]");

// Odometry.
DEFINE_double(odom_rotation_per_rotation, Defaults().factors.motion.rotation_per_rotation,
              "Odometry noise alpha_1 [rad per rad]");
DEFINE_double(odom_rotation_per_translation_rad_m,
              Defaults().factors.motion.rotation_per_translation_rad_m,
              "Odometry noise alpha_2 [rad per m]");
DEFINE_double(odom_translation_per_translation,
              Defaults().factors.motion.translation_per_translation,
              "Odometry noise alpha_3 [m per m]");
DEFINE_double(odom_translation_per_rotation_m_rad,
              Defaults().factors.motion.translation_per_rotation_m_rad,
              "Odometry noise alpha_4 [m per rad]");
DEFINE_double(odom_translation_floor_m, Defaults().factors.motion.translation_floor_m,
              "Odometry noise of a step of no length [m]");
DEFINE_double(odom_rotation_floor_rad, Defaults().factors.motion.rotation_floor_rad,
              "Odometry noise of a step without turning [rad]");

// Associations and rounds.
DEFINE_string(
    neighborhood, ToString(Defaults().association.neighborhood),
    "Neighbourhood of a tangent line: radius, or nearest (the published form; not with the "
    "reduced solver)");
DEFINE_int32(min_neighbors, Defaults().association.min_points,
             "Fewest points of a tangent line's neighbourhood");
DEFINE_int32(max_neighbors, Defaults().association.max_points,
             "Most points of a neighbourhood with --neighborhood=nearest");
DEFINE_bool(several_poses, Defaults().association.several_poses,
            "A tangent line of single points needs those of more than one pose");
DEFINE_double(
    patch_size_m, Defaults().association.patch_size_m,
    "reduced: side of the largest patch, or 32 standard deviations of a return if that is "
    "more; patches are split down to an eighth of it [m]");
DEFINE_double(max_eigenvalue_ratio, Defaults().association.max_eigenvalue_ratio,
              "Neighbourhoods rounder than this are no surface [smaller over larger variance]");
DEFINE_double(min_segment_length_m, Defaults().association.min_segment_length_m,
              "Length of the surface regions of the shape terms [m]");
DEFINE_double(shape_margin_deg, plumbline::RadToDeg(Defaults().association.shape_margin_rad),
              "Regions this close to parallel or orthogonal get a shape term [deg]");
DEFINE_int32(coarse_rounds, Defaults().rounds.max_coarse_rounds,
             "Not reduced: most rounds with wide neighbourhoods, which pull double walls together");
DEFINE_int32(fine_rounds, Defaults().rounds.max_fine_rounds,
             "Not reduced: most rounds with narrow neighbourhoods; each rebuilds the associations");
DEFINE_double(coarse_radius_m, Defaults().rounds.coarse_radius_m,
              "Not reduced: smallest neighbourhood radius in the first coarse round [m]");
DEFINE_double(
    fine_radius_m, Defaults().rounds.fine_radius_m,
    "Smallest neighbourhood radius of the final tangent lines and of the fine rounds [m]");
DEFINE_double(coarse_gate_factor, Defaults().rounds.coarse_gate_factor,
              "Not reduced: factor on the robust gates in the first coarse round");
DEFINE_double(round_tolerance, Defaults().rounds.relative_tolerance,
              "Not reduced: fine rounds end when one gains less [fraction of the marginal energy]");

// --solver=reduced
DEFINE_int32(reduced_max_rounds, Defaults().reduced.max_rounds,
             "reduced: most rounds; each cuts the surfaces into patches anew");
DEFINE_int32(reduced_steps, Defaults().reduced.steps_per_round,
             "reduced: Gauss-Newton steps per round, at most");
DEFINE_bool(reduced_lines_follow, Defaults().reduced.lines_follow,
            "reduced: tangent lines follow the poses; otherwise they are fixed within a round");
DEFINE_double(reduced_first_gate_factor, Defaults().reduced.first_gate_factor,
              "reduced: factor on the robust gate in the first round");
DEFINE_double(reduced_tolerance, Defaults().reduced.relative_tolerance,
              "reduced: ends when a round gains less in its last step [fraction of the cost], and");
DEFINE_double(reduced_move_tolerance, Defaults().reduced.move_tolerance_sigmas,
              "reduced: moves returns across their surfaces by less [standard deviations]");
DEFINE_double(
    reduced_cg_tolerance, Defaults().reduced.cg_tolerance,
    "reduced: conjugate gradients on a linear system end at this fraction of its right-hand side");
DEFINE_int32(reduced_polish_sweeps, Defaults().reduced.polish_sweeps,
             "reduced: sweeps of alternating_cg afterwards, on the exact energy of all points");

// --solver=alternating_cg
DEFINE_int32(cg_max_sweeps, Defaults().alternating_cg.max_sweeps,
             "alternating_cg: most sweeps over map, poses and scans per round");
DEFINE_int32(cg_map_iterations, Defaults().alternating_cg.map_iterations_per_sweep,
             "alternating_cg: iterations on the map per sweep");
DEFINE_int32(cg_pose_iterations, Defaults().alternating_cg.pose_iterations_per_sweep,
             "alternating_cg: iterations on the poses per sweep");
DEFINE_int32(cg_scan_iterations, Defaults().alternating_cg.scan_iterations_per_sweep,
             "alternating_cg: iterations on poses that carry their points; 0: as published");
DEFINE_double(cg_tolerance, Defaults().alternating_cg.relative_cost_tolerance,
              "alternating_cg: ends a round when a sweep gains less [fraction of the cost]");

// --solver=ceres
DEFINE_string(ceres_minimizer, ceres::MinimizerTypeToString(Defaults().ceres.minimizer),
              "trust_region or line_search");
DEFINE_string(ceres_trust_region_strategy,
              ceres::TrustRegionStrategyTypeToString(Defaults().ceres.trust_region_strategy),
              "levenberg_marquardt or dogleg");
DEFINE_string(ceres_dogleg, ceres::DoglegTypeToString(Defaults().ceres.dogleg),
              "traditional_dogleg or subspace_dogleg");
DEFINE_string(ceres_line_search_direction,
              ceres::LineSearchDirectionTypeToString(Defaults().ceres.line_search_direction),
              "steepest_descent, nonlinear_conjugate_gradient, lbfgs or bfgs");
DEFINE_string(ceres_line_search, ceres::LineSearchTypeToString(Defaults().ceres.line_search),
              "armijo or wolfe");
DEFINE_string(
    ceres_nonlinear_conjugate_gradient,
    ceres::NonlinearConjugateGradientTypeToString(Defaults().ceres.nonlinear_conjugate_gradient),
    "fletcher_reeves, polak_ribiere or hestenes_stiefel");
DEFINE_string(ceres_linear_solver, ceres::LinearSolverTypeToString(Defaults().ceres.linear_solver),
              "sparse_schur, iterative_schur, dense_schur, sparse_normal_cholesky, cgnr, dense_qr "
              "or dense_normal_cholesky");
DEFINE_string(ceres_preconditioner,
              ceres::PreconditionerTypeToString(Defaults().ceres.preconditioner),
              "identity, jacobi, schur_jacobi, cluster_jacobi, cluster_tridiagonal or subset");
DEFINE_bool(reduced, Defaults().ceres.reduced,
            "ceres: minimise over poses and the lines of patches, in the rounds of the reduced "
            "solver");
DEFINE_int32(ceres_max_iterations, Defaults().ceres.max_iterations,
             "Most iterations of Ceres per round; with --reduced, per step");
DEFINE_double(ceres_function_tolerance, Defaults().ceres.function_tolerance,
              "Ends a round when an iteration gains less [fraction of the cost]");

// --solver=sgd
DEFINE_int32(sgd_iterations, Defaults().sgd.max_iterations,
             "sgd: most iterations; each goes through all edges of the pose graph once");

// Seeding.
DEFINE_double(key_scan_distance_m, SeedingDefaults().sequential.key_scan_distance_m,
              "Seeding: travel from one key scan to the next [m]");
DEFINE_double(key_scan_angle_deg,
              plumbline::RadToDeg(SeedingDefaults().sequential.key_scan_angle_rad),
              "Seeding: turning from one key scan to the next [deg]");

namespace plumbline {
namespace {

// Sets *value from a flag by one of the FromString functions, which know all the names.
template <typename Parse, typename Value>
Status ParseName(const char* flag, const std::string& name, const Parse& parse, Value* value) {
  if (parse(name, value)) return Status::Ok();
  return Status::InvalidArgument(std::string("--") + flag + "=" + name +
                                 ": no such name; see --help");
}

// The option's name is that of the field; the flag's name is close to it.
template <typename Options>
Status CheckValues(const Options& options) {
  std::string error;
  if (options.Check(&error)) return Status::Ok();
  return Status::InvalidArgument("the flags set " + error);
}

FactorOptions FactorOptionsFromFlags() {
  FactorOptions factors;
  factors.beam.sigma_range_m = FLAGS_sigma_range_m;
  factors.beam.sigma_bearing_rad = FLAGS_sigma_bearing_rad;
  factors.manifold.sigma_m = FLAGS_sigma_manifold_m;
  factors.manifold.robust_gate_sigmas = FLAGS_manifold_gate;
  factors.shape.enabled = FLAGS_shape;
  factors.shape.sigma_rad = FLAGS_sigma_shape_rad;
  factors.shape.robust_gate_sigmas = FLAGS_shape_gate;
  factors.motion.rotation_per_rotation = FLAGS_odom_rotation_per_rotation;
  factors.motion.rotation_per_translation_rad_m = FLAGS_odom_rotation_per_translation_rad_m;
  factors.motion.translation_per_translation = FLAGS_odom_translation_per_translation;
  factors.motion.translation_per_rotation_m_rad = FLAGS_odom_translation_per_rotation_m_rad;
  factors.motion.translation_floor_m = FLAGS_odom_translation_floor_m;
  factors.motion.rotation_floor_rad = FLAGS_odom_rotation_floor_rad;
  return factors;
}

Status CeresOptionsFromFlags(CeresOptions* options) {
  PLUMBLINE_RETURN_IF_ERROR(ParseName("ceres_minimizer", FLAGS_ceres_minimizer,
                                      ceres::StringToMinimizerType, &options->minimizer));
  PLUMBLINE_RETURN_IF_ERROR(
      ParseName("ceres_trust_region_strategy", FLAGS_ceres_trust_region_strategy,
                ceres::StringToTrustRegionStrategyType, &options->trust_region_strategy));
  PLUMBLINE_RETURN_IF_ERROR(
      ParseName("ceres_dogleg", FLAGS_ceres_dogleg, ceres::StringToDoglegType, &options->dogleg));
  PLUMBLINE_RETURN_IF_ERROR(
      ParseName("ceres_line_search_direction", FLAGS_ceres_line_search_direction,
                ceres::StringToLineSearchDirectionType, &options->line_search_direction));
  PLUMBLINE_RETURN_IF_ERROR(ParseName("ceres_line_search", FLAGS_ceres_line_search,
                                      ceres::StringToLineSearchType, &options->line_search));
  PLUMBLINE_RETURN_IF_ERROR(ParseName(
      "ceres_nonlinear_conjugate_gradient", FLAGS_ceres_nonlinear_conjugate_gradient,
      ceres::StringToNonlinearConjugateGradientType, &options->nonlinear_conjugate_gradient));
  PLUMBLINE_RETURN_IF_ERROR(ParseName("ceres_linear_solver", FLAGS_ceres_linear_solver,
                                      ceres::StringToLinearSolverType, &options->linear_solver));
  PLUMBLINE_RETURN_IF_ERROR(ParseName("ceres_preconditioner", FLAGS_ceres_preconditioner,
                                      ceres::StringToPreconditionerType, &options->preconditioner));
  options->reduced = FLAGS_reduced;
  options->max_iterations = FLAGS_ceres_max_iterations;
  options->function_tolerance = FLAGS_ceres_function_tolerance;
  return Status::Ok();
}

}  // namespace

Status SolverOptionsFromFlags(SolverOptions* options) {
  const auto solver_from_string = [](const std::string& name, SolverType* type) {
    return FromString(name, type);
  };
  const auto neighborhood_from_string = [](const std::string& name, NeighborhoodType* type) {
    return FromString(name, type);
  };
  *options = SolverOptions();
  PLUMBLINE_RETURN_IF_ERROR(ParseName("solver", FLAGS_solver, solver_from_string, &options->type));
  PLUMBLINE_RETURN_IF_ERROR(ParseName("neighborhood", FLAGS_neighborhood, neighborhood_from_string,
                                      &options->association.neighborhood));
  PLUMBLINE_RETURN_IF_ERROR(CeresOptionsFromFlags(&options->ceres));
  if (options->ceres.reduced && options->type != SolverType::kCeres) {
    return Status::InvalidArgument("--reduced is a form of --solver=ceres, not of --solver=" +
                                   FLAGS_solver);
  }
  if (options->association.neighborhood == NeighborhoodType::kNearest &&
      (options->type == SolverType::kReduced || options->ceres.reduced)) {
    return Status::InvalidArgument(
        "--neighborhood=nearest goes with --solver=alternating_cg or ceres, which take each "
        "point's "
        "neighbours; the reduced solver cuts surfaces into patches");
  }
  options->num_threads = FLAGS_threads;
  options->factors = FactorOptionsFromFlags();
  options->association.min_points = FLAGS_min_neighbors;
  options->association.several_poses = FLAGS_several_poses;
  options->association.patch_size_m = FLAGS_patch_size_m;
  options->association.max_points = FLAGS_max_neighbors;
  options->association.max_eigenvalue_ratio = FLAGS_max_eigenvalue_ratio;
  options->association.min_segment_length_m = FLAGS_min_segment_length_m;
  options->association.shape_margin_rad = DegToRad(FLAGS_shape_margin_deg);
  options->rounds.max_coarse_rounds = FLAGS_coarse_rounds;
  options->rounds.max_fine_rounds = FLAGS_fine_rounds;
  options->rounds.coarse_radius_m = FLAGS_coarse_radius_m;
  options->rounds.fine_radius_m = FLAGS_fine_radius_m;
  options->rounds.coarse_gate_factor = FLAGS_coarse_gate_factor;
  options->rounds.relative_tolerance = FLAGS_round_tolerance;
  options->reduced.max_rounds = FLAGS_reduced_max_rounds;
  options->reduced.steps_per_round = FLAGS_reduced_steps;
  options->reduced.lines_follow = FLAGS_reduced_lines_follow;
  options->reduced.first_gate_factor = FLAGS_reduced_first_gate_factor;
  options->reduced.relative_tolerance = FLAGS_reduced_tolerance;
  options->reduced.move_tolerance_sigmas = FLAGS_reduced_move_tolerance;
  options->reduced.cg_tolerance = FLAGS_reduced_cg_tolerance;
  options->reduced.polish_sweeps = FLAGS_reduced_polish_sweeps;
  options->sgd.max_iterations = FLAGS_sgd_iterations;
  options->alternating_cg.max_sweeps = FLAGS_cg_max_sweeps;
  options->alternating_cg.map_iterations_per_sweep = FLAGS_cg_map_iterations;
  options->alternating_cg.pose_iterations_per_sweep = FLAGS_cg_pose_iterations;
  options->alternating_cg.scan_iterations_per_sweep = FLAGS_cg_scan_iterations;
  options->alternating_cg.relative_cost_tolerance = FLAGS_cg_tolerance;
  PLUMBLINE_RETURN_IF_ERROR(CheckValues(*options));
  return options->type == SolverType::kCeres ? CheckCeresOptions(options->ceres) : Status::Ok();
}

Status SeedingOptionsFromFlags(SeedingOptions* options) {
  *options = SeedingOptions();
  options->sequential.key_scan_distance_m = FLAGS_key_scan_distance_m;
  options->sequential.key_scan_angle_rad = DegToRad(FLAGS_key_scan_angle_deg);
  return CheckValues(*options);
}

}  // namespace plumbline
