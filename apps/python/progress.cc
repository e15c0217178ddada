#include "plumbline/apps/python/progress.h"

#include <utility>

namespace plumbline {
namespace py = pybind11;

ShownIteration::ShownIteration(const IterationSummary& iteration) : IterationSummary(iteration) {
  if (iteration.poses != nullptr) shown_poses = *iteration.poses;
  poses = nullptr;
}

Progress::Progress(py::object callback) : callback_(std::move(callback)) {
  if (!callback_.is_none() && !PyCallable_Check(callback_.ptr())) {
    throw py::type_error(
        "progress: a " +
        static_cast<std::string>(py::str(py::type::of(callback_).attr("__name__"))) +
        " cannot be called");
  }
}

template <typename... Arguments>
bool Progress::GoesOn(Arguments&&... arguments) {
  const py::gil_scoped_acquire lock;
  if (raised_) return false;
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (callback_.is_none()) return true;
    // False of Python or of numpy; whatever else a function returns means nothing.
    py::detail::make_caster<bool> answer;
    return !answer.load(callback_(std::forward<Arguments>(arguments)...), /*convert=*/false) ||
           static_cast<bool>(answer);
  } catch (...) {
    raised_ = std::current_exception();
    return false;
  }
}

ProgressCallback Progress::OfSolver() {
  return [this](const IterationSummary& iteration) { return GoesOn(ShownIteration(iteration)); };
}

SeedingProgress Progress::OfSeeding() {
  return [this](SeedingPhase phase, int num_done, int num_total) {
    return GoesOn(phase, num_done, num_total);
  };
}

void Progress::RaisePending() const {
  if (raised_) std::rethrow_exception(raised_);
}

}  // namespace plumbline
