#ifndef PLUMBLINE_APPS_PYTHON_ERRORS_H_
#define PLUMBLINE_APPS_PYTHON_ERRORS_H_

#include <pybind11/pybind11.h>

#include <cstddef>
#include <string>

#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/solver_summary.h"

namespace plumbline {

/// A message as Python has it, whose file names need not be valid text.
pybind11::str TextOf(const std::string& message);

/// Raises the Python exception of the status' code, with its message, if the status is not ok.
void RaiseIfError(const Status& status);

/// Raises if a solver refused its input or came to nothing.
void RaiseIfFailed(const SolverSummary& summary);

/// Raises IndexError, with the number of things of this kind, unless 0 <= id < size.
void CheckId(const char* kind, long long id, std::size_t size);

/// Raises for options whose Check says no.
template <typename Options>
void CheckOptions(const Options& options) {
  std::string error;
  if (!options.Check(&error)) RaiseIfError(Status::InvalidArgument(error));
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PYTHON_ERRORS_H_
