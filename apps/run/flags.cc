#include "plumbline/apps/run/flags.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <sstream>
#include <variant>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/solvers/interface/ceres_options.h"

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

// The fields of --ceres, with their defaults and values.
const char* CeresHelp() {
  static const std::string help = [] {
    std::string text =
        "ceres: options of ceres::Solver by Ceres' own names, NAME=VALUE, separated by commas, "
        "e.g. "
        "linear_solver_type=iterative_schur,preconditioner_type=schur_jacobi. Iterations are per "
        "round, with --reduced per step. Names, defaults and values:";
    for (const plumbline::CeresField& field : plumbline::CeresFields()) {
      std::ostringstream value;
      std::visit([&](const auto& of) { value << std::boolalpha << of; },
                 field.get(*Defaults().ceres));
      text += std::string(text.back() == ':' ? " " : "; ") + field.name + " (" + value.str() +
              "): " + field.values;
    }
    return text;
  }();
  return help.c_str();
}

}  // namespace

DEFINE_string(
    solver, ToString(Defaults().type),
    "Minimiser of the joint energy: reduced (of the poses alone, points and tangent lines "
    "eliminated: see solvers/reduced/README.md), alternating_cg or ceres (of poses and points); "
    "published, the method of the paper; or of the pose graph alone, points riding "
    "along: pose_graph (Gauss-Newton) or sgd");
DEFINE_string(start, "",
              "Where the solver starts: seed (matching against local maps, loops closed), odometry "
              "(as it is), icp (each scan matched to the one before it, point to point), "
              "icp_point_to_line, or icp_global (after that, all scans that see the same place "
              "matched jointly); empty: icp_global for --solver=published, seed for all others");
DEFINE_int32(threads, Defaults().num_threads,
             "Threads; the result does not depend on it, but for the last digits of ceres");

// Sensor and surfaces.
DEFINE_double(
    sigma_range_m, Defaults().factors.beam.sigma_range_m,
    "Standard deviation of a range reading [m]; if neighbouring beams show more than twice as "
    "much, theirs is taken, up to 0.06 m");
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

DEFINE_bool(test_edges, Defaults().test_edges,
            "Ignore edges of a pose graph that the scans of their poses contradict");

// Associations and rounds.
DEFINE_string(
    neighborhood, ToString(Defaults().association.neighborhood),
    "Neighbourhood of a tangent line: radius, or nearest (not over landmarks), a number of "
    "points in proportion to their density");
DEFINE_int32(min_neighbors, Defaults().association.min_points,
             "Fewest points of a tangent line's neighbourhood");
DEFINE_int32(
    max_neighbors, Defaults().association.max_points,
    "Most points of a neighbourhood with --neighborhood=nearest, and of the published method");
DEFINE_bool(several_poses, Defaults().association.several_poses,
            "A tangent line of single points needs those of more than one pose");
DEFINE_double(
    landmark_size_m, Defaults().association.landmark_size_m,
    "Side of the largest landmark, also of those by which results are judged, or 32 standard "
    "deviations of a return if that is more; landmarks are split down to an eighth of it [m]");
DEFINE_double(max_eigenvalue_ratio, Defaults().association.max_eigenvalue_ratio,
              "Neighbourhoods rounder than this are no surface [smaller over larger variance]");
DEFINE_double(min_segment_length_m, Defaults().association.min_segment_length_m,
              "Length of the surface regions of the shape terms [m]");
DEFINE_double(shape_margin_deg, plumbline::RadToDeg(Defaults().association.shape_margin_rad),
              "Regions this close to parallel or orthogonal get a shape term [deg]");
DEFINE_int32(coarse_rounds, Defaults().rounds.max_coarse_rounds,
             "In rounds: most rounds with wide neighbourhoods, which pull double walls together");
DEFINE_int32(fine_rounds, Defaults().rounds.max_fine_rounds,
             "In rounds: most rounds with narrow neighbourhoods; each rebuilds the associations");
DEFINE_double(coarse_radius_m, Defaults().rounds.coarse_radius_m,
              "Smallest neighbourhood radius in the first coarse round, and where the start of a "
              "pose graph file is compared with its edges [m]");
DEFINE_double(
    fine_radius_m, Defaults().rounds.fine_radius_m,
    "Smallest neighbourhood radius of the final tangent lines and of the fine rounds [m]");
DEFINE_double(coarse_gate_factor, Defaults().rounds.coarse_gate_factor,
              "In rounds: factor on the robust gates in the first coarse round");
DEFINE_double(round_tolerance, Defaults().rounds.relative_tolerance,
              "In rounds: fine rounds end when one gains less [fraction of the marginal energy]");

// Over landmarks: --solver=reduced, or ceres with --reduced.
DEFINE_int32(reduced_max_rounds, Defaults().reduced.max_rounds,
             "reduced: most rounds; each cuts the surfaces into landmarks anew");
DEFINE_int32(reduced_steps, Defaults().reduced.steps_per_round,
             "reduced: steps per round, at most");
DEFINE_bool(reduced_lines_follow, Defaults().reduced.lines_follow,
            "reduced: tangent lines follow the poses; otherwise they are fixed within a round");
DEFINE_double(reduced_first_gate_factor, Defaults().reduced.first_gate_factor,
              "reduced, and --calibrate: factor on the robust gate in the first round");
DEFINE_double(reduced_tolerance, Defaults().reduced.relative_tolerance,
              "reduced: ends when a round gains less in its last step [fraction of the cost], and");
DEFINE_double(reduced_move_tolerance, Defaults().reduced.move_tolerance_sigmas,
              "reduced: moves returns across their surfaces by less [standard deviations]");
DEFINE_double(
    reduced_cg_tolerance, Defaults().reduced.cg_tolerance,
    "reduced: conjugate gradients on a linear system end at this fraction of its right-hand side");
// --solver=alternating_cg.
DEFINE_int32(cg_max_sweeps, Defaults().alternating_cg.max_sweeps,
             "alternating_cg: most sweeps over map, poses and scans per round");
DEFINE_int32(cg_map_iterations, Defaults().alternating_cg.map_iterations_per_sweep,
             "alternating_cg: iterations on the map per sweep");
DEFINE_int32(cg_pose_iterations, Defaults().alternating_cg.pose_iterations_per_sweep,
             "alternating_cg: iterations on the poses per sweep");
DEFINE_int32(cg_scan_iterations, Defaults().alternating_cg.scan_iterations_per_sweep,
             "alternating_cg: iterations on poses that carry their points; 0: map and poses only");
DEFINE_double(cg_tolerance, Defaults().alternating_cg.relative_cost_tolerance,
              "alternating_cg: ends a round when a sweep gains less [fraction of the cost]; for "
              "the others see --reduced_cg_tolerance and --ceres");

// --solver=published
DEFINE_int32(published_max_passes, Defaults().published.max_passes,
             "published: most passes; each finds the prior of the map anew");
DEFINE_int32(published_sweeps, Defaults().published.sweeps_per_pass,
             "published: iterations on the map, and as many on the poses, per pass");
DEFINE_double(published_tolerance, Defaults().published.relative_tolerance,
              "published: ends when a pass gains less [fraction of the cost]");
DEFINE_bool(published_sigma_from_start, Defaults().published.sigma_from_start,
            "published: take the thickness of surfaces from the start's distances to its tangent "
            "lines, in place of --sigma_manifold_m");
DEFINE_bool(published_precondition, Defaults().published.precondition,
            "published: precondition the conjugate gradients, which the paper does not");

// --solver=ceres
DEFINE_string(ceres, "", CeresHelp());
DEFINE_bool(reduced, Defaults().ceres->reduced,
            "ceres: minimise over poses and the lines of landmarks, in the rounds of the reduced "
            "solver");

// --solver=sgd
DEFINE_int32(sgd_iterations, Defaults().sgd.max_iterations,
             "sgd: most iterations; each goes through all edges of the pose graph once");

// Seeding.
DEFINE_double(keyframe_distance_m, SeedingDefaults().sequential.keyframe_distance_m,
              "Seeding: travel from one keyframe to the next [m]");
DEFINE_double(keyframe_angle_deg,
              plumbline::RadToDeg(SeedingDefaults().sequential.keyframe_angle_rad),
              "Seeding: turning from one keyframe to the next [deg]");

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

bool UsesReturns(const SolverOptions& options) { return !options.MovesPosesOnly(); }
bool IsPublished(const SolverOptions& options) { return options.type == SolverType::kPublished; }
bool IsInRounds(const SolverOptions& options) {
  return UsesReturns(options) && !options.IsOverLandmarks() && !IsPublished(options);
}
bool HasChoices(const SolverOptions& options) {
  return UsesReturns(options) && !IsPublished(options);
}
bool TakesNearest(const SolverOptions& options) {
  return IsInRounds(options) || IsPublished(options);
}
bool IsReduced(const SolverOptions& options) { return options.type == SolverType::kReduced; }
bool IsCeres(const SolverOptions& options) { return options.type == SolverType::kCeres; }
bool IsSgd(const SolverOptions& options) { return options.type == SolverType::kSgd; }
bool IsAlternatingCg(const SolverOptions& options) {
  return options.type == SolverType::kAlternatingCg;
}
// Flags that not every solver reads. A name that ends in _ stands for all that begin with it; the
// first row that fits counts.
struct FlagReaders {
  const char* name;
  bool (*read_it)(const SolverOptions&);
};
constexpr FlagReaders kFlagReaders[] = {
    {"sigma_bearing_rad", UsesReturns},
    {"sigma_manifold_m", UsesReturns},
    {"manifold_gate", HasChoices},
    {"shape", HasChoices},
    {"sigma_shape_rad", UsesReturns},
    {"shape_gate", HasChoices},
    {"shape_", UsesReturns},
    {"test_edges", UsesReturns},
    {"neighborhood", HasChoices},
    {"min_neighbors", UsesReturns},
    {"max_neighbors", TakesNearest},
    {"several_poses", HasChoices},
    {"landmark_size_m", UsesReturns},
    {"max_eigenvalue_ratio", HasChoices},
    {"min_segment_length_m", UsesReturns},
    {"coarse_radius_m", UsesReturns},
    {"fine_radius_m", UsesReturns},
    {"coarse_", IsInRounds},
    {"fine_rounds", IsInRounds},
    {"round_tolerance", IsInRounds},
    {"reduced_cg_tolerance", IsReduced},
    {"reduced_lines_follow", IsReduced},
    {"reduced_first_gate_factor", UsesReturns},  // the calibration does, with any solver
    {"reduced_", [](const SolverOptions& options) { return options.IsOverLandmarks(); }},
    {"reduced", IsCeres},
    {"ceres", IsCeres},
    {"cg_max_sweeps", IsAlternatingCg},
    {"cg_", IsAlternatingCg},
    {"published_", IsPublished},
    {"sgd_", IsSgd},
};

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

Status AssociationOptionsFromFlags(AssociationOptions* options) {
  const auto from_string = [](const std::string& name, NeighborhoodType* type) {
    return FromString(name, type);
  };
  PLUMBLINE_RETURN_IF_ERROR(
      ParseName("neighborhood", FLAGS_neighborhood, from_string, &options->neighborhood));
  options->min_points = FLAGS_min_neighbors;
  options->several_poses = FLAGS_several_poses;
  options->landmark_size_m = FLAGS_landmark_size_m;
  options->max_points = FLAGS_max_neighbors;
  options->max_eigenvalue_ratio = FLAGS_max_eigenvalue_ratio;
  options->min_segment_length_m = FLAGS_min_segment_length_m;
  options->shape_margin_rad = DegToRad(FLAGS_shape_margin_deg);
  return Status::Ok();
}

RoundOptions RoundOptionsFromFlags() {
  RoundOptions rounds;
  rounds.max_coarse_rounds = FLAGS_coarse_rounds;
  rounds.max_fine_rounds = FLAGS_fine_rounds;
  rounds.coarse_radius_m = FLAGS_coarse_radius_m;
  rounds.fine_radius_m = FLAGS_fine_radius_m;
  rounds.coarse_gate_factor = FLAGS_coarse_gate_factor;
  rounds.relative_tolerance = FLAGS_round_tolerance;
  return rounds;
}

ReducedOptions ReducedOptionsFromFlags() {
  ReducedOptions reduced;
  reduced.max_rounds = FLAGS_reduced_max_rounds;
  reduced.steps_per_round = FLAGS_reduced_steps;
  reduced.lines_follow = FLAGS_reduced_lines_follow;
  reduced.first_gate_factor = FLAGS_reduced_first_gate_factor;
  reduced.relative_tolerance = FLAGS_reduced_tolerance;
  reduced.move_tolerance_sigmas = FLAGS_reduced_move_tolerance;
  reduced.cg_tolerance = FLAGS_reduced_cg_tolerance;
  return reduced;
}

AlternatingCgOptions AlternatingCgOptionsFromFlags() {
  AlternatingCgOptions cg;
  cg.max_sweeps = FLAGS_cg_max_sweeps;
  cg.map_iterations_per_sweep = FLAGS_cg_map_iterations;
  cg.pose_iterations_per_sweep = FLAGS_cg_pose_iterations;
  cg.scan_iterations_per_sweep = FLAGS_cg_scan_iterations;
  cg.relative_cost_tolerance = FLAGS_cg_tolerance;
  return cg;
}

PublishedOptions PublishedOptionsFromFlags() {
  PublishedOptions published;
  published.max_passes = FLAGS_published_max_passes;
  published.sweeps_per_pass = FLAGS_published_sweeps;
  published.relative_tolerance = FLAGS_published_tolerance;
  published.sigma_from_start = FLAGS_published_sigma_from_start;
  published.precondition = FLAGS_published_precondition;
  return published;
}

// The entries of a list that commas separate.
std::vector<std::string> Entries(const std::string& list) {
  std::vector<std::string> entries;
  std::istringstream stream(list);
  for (std::string entry; std::getline(stream, entry, ',');) entries.push_back(entry);
  return entries;
}

// Calls set(name, value) with each entry NAME=VALUE of a list.
template <typename Set>
Status SetFields(const char* flag, const std::string& list, const Set& set) {
  for (const std::string& entry : Entries(list)) {
    const std::size_t equals = entry.find('=');
    const Status status = equals == std::string::npos
                              ? Status::InvalidArgument("want NAME=VALUE, see --help")
                              : set(entry.substr(0, equals), entry.substr(equals + 1));
    if (status.ok()) continue;
    return Status::InvalidArgument(std::string("--") + flag + "=" + entry + ": " +
                                   status.message());
  }
  return Status::Ok();
}

Status CeresOptionsFromFlags(CeresOptions* options) {
  options->reduced = FLAGS_reduced;
  return SetFields("ceres", FLAGS_ceres, [&](const std::string& name, const std::string& value) {
    return SetCeresField(name, value, options);
  });
}

}  // namespace

Status SolverOptionsFromFlags(SolverOptions* options) {
  const auto solver_from_string = [](const std::string& name, SolverType* type) {
    return FromString(name, type);
  };
  *options = SolverOptions();
  PLUMBLINE_RETURN_IF_ERROR(ParseName("solver", FLAGS_solver, solver_from_string, &options->type));
  PLUMBLINE_RETURN_IF_ERROR(AssociationOptionsFromFlags(&options->association));
  PLUMBLINE_RETURN_IF_ERROR(CeresOptionsFromFlags(&*options->ceres));
  options->num_threads = FLAGS_threads;
  options->test_edges = FLAGS_test_edges;
  options->factors = FactorOptionsFromFlags();
  options->rounds = RoundOptionsFromFlags();
  options->reduced = ReducedOptionsFromFlags();
  options->alternating_cg = AlternatingCgOptionsFromFlags();
  options->published = PublishedOptionsFromFlags();
  options->sgd.max_iterations = FLAGS_sgd_iterations;
  return CheckValues(*options);
}

std::vector<std::string> GivenCeresFields() {
  std::vector<std::string> names;
  for (const std::string& entry : Entries(FLAGS_ceres)) {
    names.push_back(entry.substr(0, entry.find('=')));
  }
  return names;
}

bool IsIgnored(const std::string& flag, const SolverOptions& options, StartType start) {
  if (flag.find("keyframe_") == 0) return start != StartType::kSeed && UsesReturns(options);
  const auto* readers =
      std::find_if(std::begin(kFlagReaders), std::end(kFlagReaders), [&](const FlagReaders& row) {
        const std::string name = row.name;
        return flag == name || (name.back() == '_' && flag.compare(0, name.size(), name) == 0);
      });
  return readers != std::end(kFlagReaders) && !readers->read_it(options);
}

Status CheckNoFlagIsIgnored(const SolverOptions& options, StartType start) {
  std::vector<gflags::CommandLineFlagInfo> flags;
  gflags::GetAllFlags(&flags);
  for (const gflags::CommandLineFlagInfo& flag : flags) {
    if (flag.is_default || !IsIgnored(flag.name, options, start)) continue;
    if (!IsIgnored(flag.name, options, StartType::kSeed)) {
      return Status::InvalidArgument("--" + flag.name +
                                     " is ignored by --start=" + ToString(start));
    }
    const bool ceres_reduced = IsCeres(options) && options.IsOverLandmarks();
    return Status::InvalidArgument("--" + flag.name + " is ignored by --solver=" +
                                   ToString(options.type) + (ceres_reduced ? " --reduced" : ""));
  }
  return Status::Ok();
}

Status StartFromFlags(const SolverOptions& solver, StartType* start) {
  if (FLAGS_start.empty()) {
    *start = solver.type == SolverType::kPublished ? StartType::kIcpGlobal : StartType::kSeed;
    return Status::Ok();
  }
  return ParseName(
      "start", FLAGS_start,
      [](const std::string& name, StartType* type) { return FromString(name, type); }, start);
}

Status SeedingOptionsFromFlags(SeedingOptions* options) {
  *options = SeedingOptions();
  options->sequential.keyframe_distance_m = FLAGS_keyframe_distance_m;
  options->sequential.keyframe_angle_rad = DegToRad(FLAGS_keyframe_angle_deg);
  return CheckValues(*options);
}

}  // namespace plumbline
