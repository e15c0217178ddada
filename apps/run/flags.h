#ifndef PLUMBLINE_APPS_RUN_FLAGS_H_
#define PLUMBLINE_APPS_RUN_FLAGS_H_

#include <string>
#include <vector>

#include "plumbline/core/status.h"
#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// The solver options that the command line asks for. InvalidArgument on an unknown name (naming
/// the flag), a value out of range (naming the option) or switches that Ceres refuses together.
Status SolverOptionsFromFlags(SolverOptions* options);

/// The names of the fields that --ceres sets, in its order.
std::vector<std::string> GivenCeresFields();

/// True if a run of this solver from this start does not read the flag.
bool IsIgnored(const std::string& flag, const SolverOptions& options, StartType start);

/// InvalidArgument names a flag on the command line that the solver of these options does not read,
/// or that nothing reads with this start.
Status CheckNoFlagIsIgnored(const SolverOptions& options, StartType start = StartType::kSeed);

/// The seeding options that the command line asks for. InvalidArgument names the option.
Status SeedingOptionsFromFlags(SeedingOptions* options);

/// Where --start says that the solver starts; if it does not, where this one starts by default.
/// InvalidArgument on an unknown name.
Status StartFromFlags(const SolverOptions& solver, StartType* start);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_RUN_FLAGS_H_
