#include "plumbline/apps/python/objects.h"

#include <algorithm>
#include <string>
#include <vector>

#include "plumbline/apps/python/arrays.h"
#include "plumbline/apps/python/errors.h"
#include "plumbline/solvers/solver_input.h"

namespace plumbline {
namespace py = pybind11;
namespace {

// Null unless an array has this shape and numbers of type double, row by row.
const double* NumbersIn(const py::array& array, int columns) {
  const bool has_rows = py::isinstance<py::array_t<double, py::array::c_style>>(array) &&
                        array.ndim() == 2 && array.shape(1) == columns;
  return has_rows ? static_cast<const double*>(array.data()) : nullptr;
}

bool CanTake(const std::vector<double>& values, int columns, const py::array& array) {
  return NumbersIn(array, columns) != nullptr && array.writeable() &&
         static_cast<std::size_t>(array.size()) == values.size();
}

std::vector<double> CopyOf(const char* name, const py::array& array, int columns) {
  const double* numbers = NumbersIn(array, columns);
  if (numbers == nullptr) {
    throw py::value_error(std::string(name) +
                          " of the state: the array is no longer one of shape "
                          "(N, " +
                          std::to_string(columns) + ") and type float64, row by row");
  }
  return std::vector<double>(numbers, numbers + array.size());
}

void CheckWritable(const char* name, const py::array& array) {
  if (!array.writeable()) {
    throw py::value_error(std::string(name) + " of the state: the array is read-only");
  }
}

void WriteInto(std::vector<double> values, int columns, py::array* array) {
  if (CanTake(values, columns, *array)) {
    std::copy(values.begin(), values.end(), static_cast<double*>(array->mutable_data()));
  } else {
    *array = ArrayOf(std::move(values), columns);
  }
}

}  // namespace

SlamGraph* GraphObject::Mutable() {
  if (num_readers_ > 0) {
    RaiseIfError(Status::Unavailable(
        "the graph cannot change while the library works on it, in a callback or in a thread"));
  }
  return &graph_;
}

StateObject::StateObject(MapState state)
    : poses(ArrayOf(std::move(state.poses), 3)), points(ArrayOf(std::move(state.points), 2)) {}

MapState StateObject::State() const {
  return {CopyOf("poses", poses, 3), CopyOf("points", points, 2)};
}

MapState StateObject::StateOf(const SlamGraph& graph) const {
  MapState state = State();
  RaiseIfError(CheckStateSize(graph, state));
  return state;
}

MapState StateObject::FiniteStateOf(const SlamGraph& graph) const {
  MapState state = StateOf(graph);
  CheckReach("poses of the state", state.poses, 3);
  CheckReach("points of the state", state.points, 2);
  return state;
}

MapState StateObject::WritableStateOf(const SlamGraph& graph) const {
  CheckWritable("poses", poses);
  CheckWritable("points", points);
  return StateOf(graph);
}

void StateObject::Write(MapState state) {
  WriteInto(std::move(state.poses), 3, &poses);
  WriteInto(std::move(state.points), 2, &points);
}

std::vector<double> PosesFor(const SlamGraph& graph, const py::object& poses) {
  std::vector<double> rows = RowsOf("poses", poses, 3);
  if (rows.size() != graph.initial_poses().size()) {
    throw py::value_error("poses: " + std::to_string(rows.size() / 3) + " rows for a graph of " +
                          std::to_string(graph.num_poses()) + " poses");
  }
  CheckReach("poses", rows, 3);
  return rows;
}

std::vector<double> WritablePosesFor(const SlamGraph& graph, const py::array& poses) {
  std::vector<double> rows = PosesFor(graph, poses);
  if (!CanTake(rows, 3, poses)) {
    throw py::value_error(
        "poses: the result is written into the array, which must be of type float64, row by row, "
        "and writable");
  }
  return rows;
}

void WritePoses(const std::vector<double>& values, py::array* poses) {
  if (!CanTake(values, 3, *poses)) {
    throw py::value_error("poses: the array was changed while the library worked");
  }
  std::copy(values.begin(), values.end(), static_cast<double*>(poses->mutable_data()));
}

}  // namespace plumbline
