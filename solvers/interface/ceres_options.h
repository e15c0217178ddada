#ifndef PLUMBLINE_SOLVERS_INTERFACE_CERES_OPTIONS_H_
#define PLUMBLINE_SOLVERS_INTERFACE_CERES_OPTIONS_H_

#include <ceres/solver.h>

#include <string>
#include <variant>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// Ceres' own options, with defaults that suit the joint estimation. The documentation of Ceres
/// explains them. A combination that Ceres refuses is reported as an error.
/// The library sets num_threads, logging_type and update_state_every_iteration by itself, the order
/// of elimination for Schur solvers, and with `reduced` the inner iterations.
struct CeresOptions : ceres::Solver::Options {
  /// Five iterations per round by SPARSE_SCHUR, function_tolerance 1e-4.
  CeresOptions();

  /// Ceres minimises over the poses and the lines of landmarks, points eliminated, between the
  /// re-weightings of the reduced solver's rounds (ReducedOptions); else over the poses and points
  /// in rounds of associations (RoundOptions).
  bool reduced = false;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const;
};

/// Fails on a combination of options that the installed Ceres refuses, with its own words, or that
/// would abort in it.
Status CheckCeresOptions(const CeresOptions& options);

/// The value of a field of ceres::Solver::Options; of an enumeration, its name in Ceres.
using CeresValue = std::variant<bool, int, double, std::string>;

/// A field of ceres::Solver::Options that is set by its name and a text.
struct CeresField {
  const char* name;    ///< as Ceres has it, e.g. "linear_solver_type"
  const char* values;  ///< what `set` takes, for messages
  /// False, with the options unchanged, if the text is no value of the field. Names are taken in
  /// any case.
  bool (*set)(const std::string& text, CeresOptions* options);
  CeresValue (*get)(const CeresOptions& options);  ///< the value in force
};

/// All such fields.
const std::vector<CeresField>& CeresFields();

/// The field of that name; null if there is none.
const CeresField* FindCeresField(const std::string& name);

/// Sets the field of that name. InvalidArgument names the field, and the names or values that there
/// are, on an unknown name or on a text that is no value of the field.
Status SetCeresField(const std::string& name, const std::string& text, CeresOptions* options);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_CERES_OPTIONS_H_
