#include "plumbline/solvers/interface/ceres_options.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <system_error>
#include <type_traits>
#include <utility>

#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

using NativeOptions = ceres::Solver::Options;

// A field whose values have names.
template <auto Field, auto Parse, auto NameOf>
CeresField Choice(const char* name, const char* values) {
  return {name, values,
          [](const std::string& text, CeresOptions* options) {
            return Parse(text, &(options->*Field));
          },
          [](const CeresOptions& options) -> CeresValue {
            return std::string(NameOf(options.*Field));
          }};
}

bool ParseValue(const std::string& text, bool* value) {
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  if (lower != "true" && lower != "false") return false;
  *value = lower == "true";
  return true;
}

template <typename Number>
bool ParseValue(const std::string& text, Number* value) {
  Number number{};
  const char* const end = text.data() + text.size();
  const std::from_chars_result result = std::from_chars(text.data(), end, number);
  if (result.ec != std::errc() || result.ptr != end) return false;
  if (!std::isfinite(static_cast<double>(number))) return false;
  *value = number;
  return true;
}

// A field that is a number or a switch.
template <auto Field>
CeresField Plain(const char* name) {
  using Value = std::decay_t<decltype(std::declval<CeresOptions&>().*Field)>;
  const char* values = std::is_same_v<Value, bool>  ? "true or false"
                       : std::is_same_v<Value, int> ? "a whole number"
                                                    : "a finite number";
  return {name, values,
          [](const std::string& text, CeresOptions* options) {
            return ParseValue(text, &(options->*Field));
          },
          [](const CeresOptions& options) -> CeresValue { return options.*Field; }};
}

// The functions between a name and its value are called alike in Ceres for all enumerations.
#define PLUMBLINE_CHOICE(field, Type, values) \
  Choice<&NativeOptions::field, ceres::StringTo##Type, ceres::Type##ToString>(#field, values)
#define PLUMBLINE_PLAIN(field) Plain<&NativeOptions::field>(#field)

std::vector<CeresField> MakeFields() {
  return {
      PLUMBLINE_CHOICE(minimizer_type, MinimizerType, "trust_region or line_search"),
      PLUMBLINE_CHOICE(linear_solver_type, LinearSolverType,
                       "dense_normal_cholesky, dense_qr, sparse_normal_cholesky, dense_schur, "
                       "sparse_schur, iterative_schur or cgnr"),
      PLUMBLINE_CHOICE(
          preconditioner_type, PreconditionerType,
          "identity, jacobi, schur_jacobi, cluster_jacobi, cluster_tridiagonal or subset"),
      PLUMBLINE_CHOICE(trust_region_strategy_type, TrustRegionStrategyType,
                       "levenberg_marquardt or dogleg"),
      PLUMBLINE_CHOICE(dogleg_type, DoglegType, "traditional_dogleg or subspace_dogleg"),
      PLUMBLINE_CHOICE(line_search_direction_type, LineSearchDirectionType,
                       "steepest_descent, nonlinear_conjugate_gradient, lbfgs or bfgs"),
      PLUMBLINE_CHOICE(nonlinear_conjugate_gradient_type, NonlinearConjugateGradientType,
                       "fletcher_reeves, polak_ribiere or hestenes_stiefel"),
      PLUMBLINE_CHOICE(line_search_type, LineSearchType, "armijo or wolfe"),
      PLUMBLINE_CHOICE(sparse_linear_algebra_library_type, SparseLinearAlgebraLibraryType,
                       "suite_sparse, eigen_sparse or another that Ceres was built with"),
      PLUMBLINE_PLAIN(max_num_iterations),
      PLUMBLINE_PLAIN(function_tolerance),
      PLUMBLINE_PLAIN(gradient_tolerance),
      PLUMBLINE_PLAIN(parameter_tolerance),
      PLUMBLINE_PLAIN(initial_trust_region_radius),
      PLUMBLINE_PLAIN(max_trust_region_radius),
      PLUMBLINE_PLAIN(use_nonmonotonic_steps),
      PLUMBLINE_PLAIN(max_lbfgs_rank),
      PLUMBLINE_PLAIN(use_explicit_schur_complement),
      PLUMBLINE_PLAIN(min_linear_solver_iterations),
      PLUMBLINE_PLAIN(max_linear_solver_iterations),
      PLUMBLINE_PLAIN(eta),
      PLUMBLINE_PLAIN(jacobi_scaling),
  };
}

#undef PLUMBLINE_PLAIN
#undef PLUMBLINE_CHOICE

// Combinations that Ceres' own check lets pass, and that abort the program in the solve.
bool AbortsInCeres(const CeresOptions& options) {
  const ceres::PreconditionerType preconditioner = options.preconditioner_type;
  if (options.linear_solver_type == ceres::CGNR) {
    return preconditioner != ceres::IDENTITY && preconditioner != ceres::JACOBI;
  }
  return options.linear_solver_type == ceres::ITERATIVE_SCHUR && preconditioner == ceres::SUBSET;
}

}  // namespace

CeresOptions::CeresOptions() {
  linear_solver_type = ceres::SPARSE_SCHUR;
  max_num_iterations = 5;
  function_tolerance = 1e-4;
  parameter_tolerance = 0.0;
  // Damping must not be stiffer than the bending modes of a long corridor.
  initial_trust_region_radius = 1e8;
}

bool CeresOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(max_num_iterations, 1, 1000000000);
  PLUMBLINE_CHECK_OPTION_WITHIN(function_tolerance, 0.0, 1.0);
  for (const CeresField& field : CeresFields()) {
    const CeresValue value = field.get(*this);
    const double* const number = std::get_if<double>(&value);
    if (number == nullptr || std::isfinite(*number)) continue;
    return internal::FailOption(field.name, *number, "finite", error);
  }
  return true;
}

Status CheckCeresOptions(const CeresOptions& options) {
  if (AbortsInCeres(options)) {
    return Status::InvalidArgument(std::string("ceres.preconditioner_type = ") +
                                   ceres::PreconditionerTypeToString(options.preconditioner_type) +
                                   ", but that does not work with ceres.linear_solver_type = " +
                                   ceres::LinearSolverTypeToString(options.linear_solver_type));
  }
  std::string error;
  if (options.IsValid(&error)) return Status::Ok();
  return Status::InvalidArgument("Ceres refuses its options: " + error);
}

const std::vector<CeresField>& CeresFields() {
  static const std::vector<CeresField> fields = MakeFields();
  return fields;
}

const CeresField* FindCeresField(const std::string& name) {
  const auto found = std::find_if(CeresFields().begin(), CeresFields().end(),
                                  [&](const CeresField& field) { return name == field.name; });
  return found == CeresFields().end() ? nullptr : &*found;
}

Status SetCeresField(const std::string& name, const std::string& text, CeresOptions* options) {
  const CeresField* const field = FindCeresField(name);
  if (field == nullptr) {
    std::string names;
    for (const CeresField& known : CeresFields()) {
      names += (names.empty() ? "" : ", ") + std::string(known.name);
    }
    return Status::InvalidArgument("there is no option '" + name + "' of ceres; there are " +
                                   names);
  }
  if (field->set(text, options)) return Status::Ok();
  return Status::InvalidArgument(name + " = '" + text + "', but it must be " + field->values);
}

}  // namespace plumbline
