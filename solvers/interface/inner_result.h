#ifndef PLUMBLINE_SOLVERS_INTERFACE_INNER_SOLVE_H_
#define PLUMBLINE_SOLVERS_INTERFACE_INNER_SOLVE_H_

#include <string>

namespace plumbline {

/// Outcome of minimising the joint energy for one set of associations.
struct InnerResult {
  bool usable = false;        ///< false: the energy could not be evaluated, the state is unchanged
  bool stopped = false;       ///< by the callback
  bool converged = false;     ///< by the minimiser's own tolerance
  double initial_cost = 0.0;  ///< of the joint energy
  double final_cost = 0.0;    ///< of the joint energy
  int iterations = 0;         ///< done
  double setup_time_s = 0.0;  ///< building the problem
  std::string stop_reason;    ///< with the numbers
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_INNER_SOLVE_H_
