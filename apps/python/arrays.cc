#include "plumbline/apps/python/arrays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "plumbline/solvers/solver_input.h"

namespace plumbline {
namespace py = pybind11;
namespace {

std::string ShapeText(const py::array& array) { return py::str(array.attr("shape")); }

// As doubles, row by row.
std::vector<double> RealNumbers(const std::string& name, const py::object& values, int dimensions,
                                const std::string& wanted) {
  const py::array array = py::array::ensure(values);
  if (!array) {
    PyErr_Clear();
    throw py::type_error(name + ": not an array of numbers");
  }
  if (std::string("fiu").find(array.dtype().kind()) == std::string::npos) {
    throw py::type_error(name + ": an array of type " +
                         static_cast<std::string>(py::str(array.dtype())) +
                         ", but it must be of real numbers");
  }
  if (array.ndim() != dimensions && array.size() > 0) {
    throw py::value_error(name + ": an array of shape " + ShapeText(array) +
                          ", but it must be of shape " + wanted);
  }
  const py::array_t<double, py::array::c_style | py::array::forcecast> doubles(array);
  return std::vector<double>(doubles.data(), doubles.data() + doubles.size());
}

}  // namespace

std::vector<double> NumbersOf(const std::string& name, const py::object& values) {
  return RealNumbers(name, values, 1, "(N,)");
}

std::vector<double> RowsOf(const std::string& name, const py::object& values, int columns) {
  const std::string wanted = "(N, " + std::to_string(columns) + ")";
  const py::array array = py::array::ensure(values);
  if (array && array.size() > 0 && array.ndim() == 2 && array.shape(1) != columns) {
    throw py::value_error(name + ": an array of shape " + ShapeText(array) +
                          ", but it must be of shape " + wanted);
  }
  return RealNumbers(name, values, 2, wanted);
}

Eigen::Matrix3d MatrixOf(const std::string& name, const py::object& values) {
  const std::vector<double> rows = RowsOf(name, values, 3);
  if (rows.size() != 9) {
    throw py::value_error(name + ": " + std::to_string(rows.size() / 3) +
                          " rows of 3 numbers, but it must be of shape (3, 3)");
  }
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.data());
}

void CheckReach(const std::string& name, const std::vector<double>& values, int columns) {
  const auto bad = std::find_if_not(values.begin(), values.end(), IsWithinReach);
  if (bad == values.end()) return;
  throw py::value_error(name + ": row " + std::to_string((bad - values.begin()) / columns) +
                        " is not finite, or beyond 1e8");
}

std::vector<TimedPose> TrajectoryOf(const py::object& timestamps_s, const py::object& poses) {
  const std::vector<double> times = NumbersOf("timestamps_s", timestamps_s);
  const std::vector<double> rows = RowsOf("poses", poses, 3);
  if (rows.size() != 3 * times.size()) {
    throw py::value_error(std::to_string(times.size()) + " timestamps_s, but " +
                          std::to_string(rows.size() / 3) + " poses");
  }
  CheckReach("poses", rows, 3);
  std::vector<TimedPose> trajectory;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!(std::abs(times[i]) <= 1e12)) {
      throw py::value_error("timestamps_s: number " + std::to_string(i) +
                            " is not finite, or beyond 1e12");
    }
    trajectory.push_back({times[i], Pose2(&rows[3 * i])});
  }
  return trajectory;
}

}  // namespace plumbline
