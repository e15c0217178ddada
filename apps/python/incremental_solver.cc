// The solver that goes along with a growing graph.

#include "plumbline/solvers/incremental_solver.h"

#include <utility>
#include <vector>

#include "plumbline/apps/python/bindings.h"
#include "plumbline/apps/python/errors.h"
#include "plumbline/apps/python/objects.h"

namespace plumbline {
namespace py = pybind11;
namespace {

// The solver as Python has it: for one graph, and for one thread at a time.
class IncrementalSolverObject {
 public:
  IncrementalSolverObject(const SolverOptions& options, const IncrementalOptions& incremental)
      : solver_(options, incremental) {}

  IncrementalSummary Update(const GraphObject& graph, py::array poses, UpdateScope scope) {
    const Use use(this);
    const py::object graph_object = py::cast(&graph, py::return_value_policy::reference);
    if (graph_ && !graph_.is(graph_object)) RaiseOtherGraph();
    std::vector<double> rows = WritablePosesFor(*graph, poses);
    IncrementalSummary summary;
    RaiseIfError(graph.ReadUnlocked([&](const SlamGraph& unlocked) {
      return solver_.Update(unlocked, scope, &rows, &summary);
    }));
    graph_ = graph_object;
    WritePoses(rows, &poses);
    return summary;
  }

  StateObject GetState(const GraphObject& graph) {
    const Use use(this);
    if (!graph_.is(py::cast(&graph, py::return_value_policy::reference))) RaiseOtherGraph();
    MapState state;
    RaiseIfError(graph.ReadUnlocked(
        [&](const SlamGraph& unlocked) { return solver_.GetState(unlocked, &state); }));
    return StateObject(std::move(state));
  }

 private:
  // By a call. UnavailableError while there is another one.
  class Use {
   public:
    explicit Use(IncrementalSolverObject* solver) : solver_(solver) {
      if (solver_->is_in_use_) {
        RaiseIfError(Status::Unavailable("the incremental solver is at work in another thread"));
      }
      solver_->is_in_use_ = true;
    }
    ~Use() { solver_->is_in_use_ = false; }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

   private:
    IncrementalSolverObject* solver_;
  };

  static void RaiseOtherGraph() {
    RaiseIfError(Status::InvalidArgument(
        "the graph is not the one of the last update; a copy is another graph"));
  }

  IncrementalSolver solver_;
  py::object graph_;        // a GraphObject, or null before the first update
  bool is_in_use_ = false;  // changed with Python's lock held
};

}  // namespace

void BindIncrementalSolver(py::module_* module) {
  using Solver = IncrementalSolverObject;
  py::class_<Solver>(
      *module, "IncrementalSolver",
      "Refines the poses of a graph while it grows: for robots that map while they drive. What an "
      "update of the newest poses takes does not depend on the size of the map. A solver goes with "
      "one graph, and works in one thread at a time; UnavailableError in another one.")
      .def(py::init<const SolverOptions&, const IncrementalOptions&>(),
           py::arg_v("options", SolverOptions(), "SolverOptions()"),
           py::arg_v("incremental", IncrementalOptions(), "IncrementalOptions()"),
           "Of the options factors, test_edges, association, reduced and num_threads count. Bad "
           "ones are reported by the first update.")
      .def("update", &Solver::Update, py::arg("graph"), py::arg("poses"),
           py::arg_v("scope", UpdateScope::kAutomatic, "UpdateScope.AUTOMATIC"),
           "Takes in what the graph has gained since the last update, and refines the poses, (N, "
           "3): x, y [m], yaw [rad] of world_from_robot, one row per pose of the graph, in place. "
           "The array must be of type float64 and writable. New poses must be given where odometry "
           "or a matcher puts them, seen from the refined poses before them: within a few "
           "decimetres. Where older poses differ from what the last update gave, their "
           "surroundings follow. Relative poses that their scans contradict are ignored.\n\n"
           "Python's lock is released meanwhile; the graph cannot change. Raises "
           "InvalidArgumentError or ValueError, with the poses unchanged, on bad input.")
      .def("get_state", &Solver::GetState, py::arg("graph"),
           "The map at the poses of the last update, as a MapState of its own. The graph must not "
           "have grown since. Goes through all returns.");
}

}  // namespace plumbline
