#ifndef PLUMBLINE_APPS_PYTHON_PROGRESS_H_
#define PLUMBLINE_APPS_PYTHON_PROGRESS_H_

#include <pybind11/pybind11.h>

#include <exception>
#include <vector>

#include "plumbline/solvers/interface/seeding_options.h"
#include "plumbline/solvers/interface/solver_options.h"

namespace plumbline {

/// An iteration that outlives the call of the callback: with a copy of the poses.
struct ShownIteration : IterationSummary {
  explicit ShownIteration(const IterationSummary& iteration);
  std::vector<double> shown_poses;  ///< as MapState::poses; empty where there are none
};

/// Asks Python whether to go on while the library works without its lock: handlers of signals run,
/// Ctrl-C among them, and then the caller's function. What these raise asks the library to stop,
/// and is raised once it has.
class Progress {
 public:
  /// callback: None or a callable. The lock is held.
  explicit Progress(pybind11::object callback);

  /// @{
  /// These refer to this object. False if the callable returned False, or if something was
  /// raised.
  ProgressCallback OfSolver();
  SeedingProgress OfSeeding();
  /// @}

  /// Raises what was raised meanwhile. The lock is held.
  void RaisePending() const;

 private:
  template <typename... Arguments>
  bool GoesOn(Arguments&&... arguments);

  pybind11::object callback_;
  std::exception_ptr raised_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PYTHON_PROGRESS_H_
