#include "plumbline/apps/run/flags.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <sstream>
#include <variant>
#include <vector>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/solvers/interface/ceres_options.h"

namespace {

// The library's defaults are those of the flags.
const plumbline::SolverOptions& Defaults() {
  static const plumbline::SolverOptions options;
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

// The fields of --odometry_noise, with their defaults and units.
const char* OdometryNoiseHelp() {
  static const std::string help = [] {
    std::string text =
        "Noise of the odometry, NAME=VALUE, separated by commas, by the motion model of "
        "Probabilistic Robotics, ch. 5.4. Names, defaults and units:";
    for (const plumbline::MotionField& field : plumbline::kMotionFields) {
      std::ostringstream value;
      value << Defaults().factors.motion.*field.value;
      text += std::string(text.back() == ':' ? " " : ", ") + field.name + " (" + value.str() +
              ") [" + field.unit + "]";
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

DEFINE_string(ceres, "", CeresHelp());
DEFINE_string(odometry_noise, "", OdometryNoiseHelp());
DEFINE_double(keyframe_distance_m, plumbline::SeedingOptions().keyframe_distance_m,
              "Seeding: travel from one keyframe to the next [m]");

namespace plumbline {
namespace {

// Sets *value from a flag by one of the FromString functions, which know all the names.
template <typename Parse, typename Value>
Status ParseName(const char* flag, const std::string& name, const Parse& parse, Value* value) {
  if (parse(name, value)) return Status::Ok();
  return Status::InvalidArgument(std::string("--") + flag + "=" + name +
                                 ": no such name; see --help");
}

template <typename Options>
Status CheckValues(const Options& options) {
  std::string error;
  return options.Check(&error) ? Status::Ok() : Status::InvalidArgument(error);
}

bool IsAny(const SolverOptions& /*options*/) { return true; }
bool UsesReturns(const SolverOptions& options) { return !options.MovesPosesOnly(); }
bool IsOverLandmarks(const SolverOptions& options) { return options.IsOverLandmarks(); }
bool IsPublished(const SolverOptions& options) { return options.type == SolverType::kPublished; }
bool IsInRounds(const SolverOptions& options) {
  return UsesReturns(options) && !options.IsOverLandmarks() && !IsPublished(options);
}
bool HasChoices(const SolverOptions& options) {
  return UsesReturns(options) && !IsPublished(options);
}
bool IsCeres(const SolverOptions& options) { return options.type == SolverType::kCeres; }
bool IsAlternatingCg(const SolverOptions& options) {
  return options.type == SolverType::kAlternatingCg;
}

// A flag that is a field of SolverOptions as it is.
using FieldPointer = std::variant<bool*, int*, double*>;
struct FieldFlag {
  const char* name;
  FieldPointer (*field)(SolverOptions*);
  bool (*read_it)(const SolverOptions&);  // whether a solver does
  const char* help;
};

#define PLUMBLINE_FIELD(field) \
  [](SolverOptions* options) -> FieldPointer { return &options->field; }
constexpr FieldFlag kFieldFlags[] = {
    {"threads", PLUMBLINE_FIELD(num_threads), IsAny,
     "Threads; the result does not depend on it, but for the last digits of ceres"},
    {"sigma_range_m", PLUMBLINE_FIELD(factors.beam.sigma_range_m), IsAny,
     "Standard deviation of a range reading [m]; if neighbouring beams show more than twice as "
     "much, theirs is taken, up to 0.06 m"},
    {"sigma_bearing_rad", PLUMBLINE_FIELD(factors.beam.sigma_bearing_rad), UsesReturns,
     "Standard deviation of a beam's direction, its divergence included [rad]"},
    {"sigma_manifold_m", PLUMBLINE_FIELD(factors.manifold.sigma_m), UsesReturns,
     "Thickness of a surface: standard deviation of a point off its tangent line [m]"},
    {"manifold_gate", PLUMBLINE_FIELD(factors.manifold.robust_gate_sigmas), HasChoices,
     "Robust gate of the manifold terms [standard deviations]; shape terms have 3/4 of it"},
    {"shape", PLUMBLINE_FIELD(factors.shape), HasChoices,
     "Draw adjacent surfaces to parallel or orthogonal"},
    {"test_edges", PLUMBLINE_FIELD(test_edges), UsesReturns,
     "Ignore edges of a pose graph that the scans of their poses contradict"},
    {"landmark_size_m", PLUMBLINE_FIELD(association.landmark_size_m), UsesReturns,
     "Side of the largest landmark, also of those by which results are judged, or 32 standard "
     "deviations of a return if that is more; landmarks are split down to an eighth of it [m]"},
    {"coarse_rounds", PLUMBLINE_FIELD(rounds.max_coarse_rounds), IsInRounds,
     "In rounds: most rounds with wide neighbourhoods, which pull double walls together"},
    {"fine_rounds", PLUMBLINE_FIELD(rounds.max_fine_rounds), IsInRounds,
     "In rounds: most rounds with narrow neighbourhoods; each rebuilds the associations"},
    {"reduced_max_rounds", PLUMBLINE_FIELD(reduced.max_rounds), IsOverLandmarks,
     "reduced: most rounds; each cuts the surfaces into landmarks anew"},
    {"reduced_tolerance", PLUMBLINE_FIELD(reduced.relative_tolerance), IsOverLandmarks,
     "reduced: ends when a round gains less [fraction of the cost], and hardly "
     "moves the returns"},
    {"cg_max_sweeps", PLUMBLINE_FIELD(alternating_cg.max_sweeps), IsAlternatingCg,
     "alternating_cg: most sweeps over map, poses and scans per round"},
    {"cg_scan_iterations", PLUMBLINE_FIELD(alternating_cg.scan_iterations_per_sweep),
     IsAlternatingCg,
     "alternating_cg: iterations on poses that carry their points; 0: map and poses only"},
    {"cg_tolerance", PLUMBLINE_FIELD(alternating_cg.relative_cost_tolerance), IsAlternatingCg,
     "alternating_cg: ends a round when a sweep gains less [fraction of the cost]"},
    {"published_sigma_from_start", PLUMBLINE_FIELD(published.sigma_from_start), IsPublished,
     "published: take the thickness of surfaces from the start's distances to its tangent lines, "
     "in place of --sigma_manifold_m"},
    {"reduced", PLUMBLINE_FIELD(ceres->reduced), IsCeres,
     "ceres: minimise over poses and the lines of landmarks, in the rounds of the reduced solver"},
};
#undef PLUMBLINE_FIELD

// The options that the flags above set, and their defaults.
SolverOptions& InForce() {
  static SolverOptions options;
  return options;
}
SolverOptions& FlagDefaults() {
  static SolverOptions options;
  return options;
}

[[maybe_unused]] const bool kAreRegistered = [] {
  for (const FieldFlag& flag : kFieldFlags) {
    const FieldPointer at_default = flag.field(&FlagDefaults());
    std::visit(
        [&](auto* value) {
          gflags::FlagRegisterer(flag.name, flag.help, __FILE__, value,
                                 std::get<decltype(value)>(at_default));
        },
        flag.field(&InForce()));
  }
  return true;
}();

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

Status SetMotionField(const std::string& name, const std::string& text, MotionOptions* motion) {
  const auto* field =
      std::find_if(std::begin(kMotionFields), std::end(kMotionFields),
                   [&](const MotionField& candidate) { return name == candidate.name; });
  if (field == std::end(kMotionFields)) {
    return Status::InvalidArgument("there is no such noise; see --help");
  }
  FieldReader reader(text);
  motion->*field->value = reader.Number(field->name);
  reader.ExpectEnd();
  if (!reader.ok()) return Status::InvalidArgument(reader.error());
  return CheckValues(*motion);
}

}  // namespace

Status SolverOptionsFromFlags(SolverOptions* options) {
  const auto solver_from_string = [](const std::string& name, SolverType* type) {
    return FromString(name, type);
  };
  *options = InForce();
  PLUMBLINE_RETURN_IF_ERROR(ParseName("solver", FLAGS_solver, solver_from_string, &options->type));
  PLUMBLINE_RETURN_IF_ERROR(
      SetFields("ceres", FLAGS_ceres, [&](const std::string& name, const std::string& value) {
        PLUMBLINE_RETURN_IF_ERROR(SetCeresField(name, value, &*options->ceres));
        return CheckValues(*options->ceres);
      }));
  PLUMBLINE_RETURN_IF_ERROR(SetFields("odometry_noise", FLAGS_odometry_noise,
                                      [&](const std::string& name, const std::string& value) {
                                        return SetMotionField(name, value,
                                                              &options->factors.motion);
                                      }));
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
  if (flag == "keyframe_distance_m") return start != StartType::kSeed && UsesReturns(options);
  if (flag == "ceres") return !IsCeres(options);
  const auto* found = std::find_if(std::begin(kFieldFlags), std::end(kFieldFlags),
                                   [&](const FieldFlag& row) { return flag == row.name; });
  return found != std::end(kFieldFlags) && !found->read_it(options);
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
  options->keyframe_distance_m = FLAGS_keyframe_distance_m;
  return CheckValues(*options);
}

}  // namespace plumbline
