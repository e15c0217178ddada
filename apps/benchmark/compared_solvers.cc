#include "plumbline/apps/benchmark/compared_solvers.h"

#include <ceres/types.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <iterator>
#include <utility>

#include "plumbline/solvers/interface/ceres_options.h"

namespace plumbline {
namespace {

constexpr char kSolverNames[] = "reduced, alternating_cg, published, ceres, pose_graph or sgd";
void ImplyNothing(CeresOptions* /*options*/) {}
void ImplyTrustRegion(CeresOptions* options) { options->minimizer_type = ceres::TRUST_REGION; }
void ImplyDogleg(CeresOptions* options) {
  ImplyTrustRegion(options);
  options->trust_region_strategy_type = ceres::DOGLEG;
}
void ImplyLineSearch(CeresOptions* options) { options->minimizer_type = ceres::LINE_SEARCH; }
void ImplyConjugateGradient(CeresOptions* options) {
  ImplyLineSearch(options);
  options->line_search_direction_type = ceres::NONLINEAR_CONJUGATE_GRADIENT;
}

// A field of CeresOptions whose values are words, with the fields that such a word implies.
struct CeresSwitch {
  const char* field;
  void (*imply)(CeresOptions* options);

  const CeresField& Field() const { return *FindCeresField(field); }
};
constexpr CeresSwitch kCeresSwitches[] = {
    {"minimizer_type", ImplyNothing},
    {"linear_solver_type", ImplyTrustRegion},
    {"preconditioner_type", ImplyTrustRegion},
    {"trust_region_strategy_type", ImplyTrustRegion},
    {"dogleg_type", ImplyDogleg},
    {"line_search_direction_type", ImplyLineSearch},
    {"nonlinear_conjugate_gradient_type", ImplyConjugateGradient},
    {"line_search_type", ImplyLineSearch},
};

bool SetCeresWord(const std::string& word, CeresOptions* options) {
  if (word == "reduced" || word == "points") {
    options->reduced = word == "reduced";
    return true;
  }
  return std::any_of(std::begin(kCeresSwitches), std::end(kCeresSwitches),
                     [&](const CeresSwitch& of) {
                       if (!of.Field().set(word, options)) return false;
                       of.imply(options);
                       return true;
                     });
}

std::string CeresWords() {
  std::string words = "reduced or points";
  for (const CeresSwitch& of : kCeresSwitches) words += std::string("; ") + of.Field().values;
  return words;
}

bool HaveEqualSwitches(const CeresOptions& a, const CeresOptions& b) {
  return a.reduced == b.reduced &&
         std::all_of(std::begin(kCeresSwitches), std::end(kCeresSwitches),
                     [&](const CeresSwitch& of) { return of.Field().get(a) == of.Field().get(b); });
}

// True if the second word undoes the first one.
bool Contradict(const std::string& first, const std::string& second) {
  CeresOptions options;
  SetCeresWord(first, &options);
  SetCeresWord(second, &options);
  CeresOptions again = options;
  SetCeresWord(first, &again);
  return !HaveEqualSwitches(options, again);
}

bool TakesPreconditioner(ceres::LinearSolverType solver) {
  return solver == ceres::ITERATIVE_SCHUR || solver == ceres::CGNR;
}

std::string InLowerCase(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return name;
}

// The messages of this function and the next two do not name the entry: ParseSolvers adds it.
Status SetCeresWords(const std::vector<std::string>& words, CeresOptions* options) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!SetCeresWord(words[i], options)) {
      return Status::InvalidArgument("ceres has no word '" + words[i] + "'; it has " +
                                     CeresWords());
    }
    for (std::size_t j = 0; j < i; ++j) {
      if (!Contradict(words[j], words[i])) continue;
      return Status::InvalidArgument("'" + words[j] + "' and '" + words[i] +
                                     "' contradict each other");
    }
  }
  const auto preconditioner = std::find_if(words.begin(), words.end(), [](const std::string& word) {
    CeresOptions unused;
    return ceres::StringToPreconditionerType(word, &unused.preconditioner_type);
  });
  if (preconditioner == words.end() || TakesPreconditioner(options->linear_solver_type)) {
    return Status::Ok();
  }
  return Status::InvalidArgument(
      "'" + *preconditioner + "' changes nothing: " +
      InLowerCase(ceres::LinearSolverTypeToString(options->linear_solver_type)) +
      " takes no preconditioner, but iterative_schur and cgnr do");
}

Status SetWords(const std::vector<std::string>& words, SolverOptions* options) {
  if (options->type == SolverType::kCeres) return SetCeresWords(words, &*options->ceres);
  for (const std::string& word : words) {
    const bool is_reduced = options->type == SolverType::kReduced;
    if (!is_reduced || word != "fixed_lines") {
      return Status::InvalidArgument(std::string(ToString(options->type)) + " has no word '" +
                                     word +
                                     (is_reduced ? "'; it has fixed_lines" : "'; it takes none"));
    }
    options->reduced.lines_follow = false;
  }
  return Status::Ok();
}

// The texts between separators, empty ones included.
std::vector<std::string> Split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char character : text) {
    if (character == separator) {
      parts.emplace_back();
    } else {
      parts.back() += character;
    }
  }
  return parts;
}

Status ParseEntry(const std::string& entry, const ComparisonLimits& limits,
                  SolverOptions* options) {
  std::vector<std::string> words = Split(entry, ':');
  if (!FromString(words.front(), &options->type)) {
    return Status::InvalidArgument("there is no solver '" + words.front() + "'; want " +
                                   kSolverNames);
  }
  words.erase(words.begin());
  PLUMBLINE_RETURN_IF_ERROR(SetWords(words, options));
  options->alternating_cg.max_sweeps = limits.cg_sweeps;
  if (options->ceres->minimizer_type == ceres::LINE_SEARCH) {
    options->ceres->max_num_iterations = limits.line_search_iterations;
  }
  std::string error;
  return options->Check(&error) ? Status::Ok() : Status::InvalidArgument(error);
}

std::string CeresSwitchNames(const CeresOptions& options) {
  std::string names = options.reduced ? "reduced " : "";
  if (options.minimizer_type == ceres::TRUST_REGION) {
    names += ceres::LinearSolverTypeToString(options.linear_solver_type);
    if (TakesPreconditioner(options.linear_solver_type)) {
      names += std::string(" ") + ceres::PreconditionerTypeToString(options.preconditioner_type);
    }
    if (options.trust_region_strategy_type == ceres::DOGLEG) {
      names += std::string(" ") + ceres::DoglegTypeToString(options.dogleg_type);
    }
  } else {
    names += std::string("line_search ") +
             ceres::LineSearchDirectionTypeToString(options.line_search_direction_type);
    if (options.line_search_direction_type == ceres::NONLINEAR_CONJUGATE_GRADIENT) {
      names += std::string(" ") + ceres::NonlinearConjugateGradientTypeToString(
                                      options.nonlinear_conjugate_gradient_type);
    }
    names += std::string(" ") + ceres::LineSearchTypeToString(options.line_search_type);
  }
  return InLowerCase(names);
}

}  // namespace

std::string SolverName(const SolverOptions& options) {
  std::string name = ToString(options.type);
  if (options.type == SolverType::kCeres) return name + " " + CeresSwitchNames(*options.ceres);
  if (options.type == SolverType::kReduced && !options.reduced.lines_follow) {
    name += " fixed_lines";
  }
  return name;
}

Status ParseSolvers(const std::string& list, const SolverOptions& base,
                    const ComparisonLimits& limits, std::vector<ComparedSolver>* solvers) {
  std::vector<ComparedSolver> parsed;
  const std::vector<std::string> entries = Split(list, ',');
  for (const std::string& entry : entries) {
    const auto refuse = [&](const std::string& reason) {
      return Status::InvalidArgument("entry '" + entry + "': " + reason);
    };
    ComparedSolver solver{"", base};
    const Status status = ParseEntry(entry, limits, &solver.options);
    if (!status.ok()) return refuse(status.message());
    solver.name = SolverName(solver.options);
    for (std::size_t i = 0; i < parsed.size(); ++i) {
      if (parsed[i].name != solver.name) continue;
      return refuse("it runs '" + solver.name + "', as entry '" + entries[i] + "' does");
    }
    parsed.push_back(solver);
  }
  *solvers = std::move(parsed);
  return Status::Ok();
}

Status CheckCeresFlagsCount(const std::vector<ComparedSolver>& solvers, const SolverOptions& base,
                            const std::vector<std::string>& fields, bool reduced) {
  const auto check = [&](const std::string& flag, const auto& value_of) {
    const bool counts =
        std::any_of(solvers.begin(), solvers.end(), [&](const ComparedSolver& solver) {
          return solver.options.type == SolverType::kCeres &&
                 value_of(*solver.options.ceres) == value_of(*base.ceres);
        });
    if (counts) return Status::Ok();
    return Status::InvalidArgument("--" + flag + " is ignored by every entry of --solvers");
  };
  for (const CeresSwitch& of : kCeresSwitches) {
    if (std::find(fields.begin(), fields.end(), of.field) == fields.end()) continue;
    PLUMBLINE_RETURN_IF_ERROR(check(std::string("ceres=") + of.field, of.Field().get));
  }
  if (!reduced) return Status::Ok();
  return check("reduced", [](const CeresOptions& options) { return options.reduced; });
}

}  // namespace plumbline
