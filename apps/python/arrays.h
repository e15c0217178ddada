#ifndef PLUMBLINE_APPS_PYTHON_ARRAYS_H_
#define PLUMBLINE_APPS_PYTHON_ARRAYS_H_

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/trajectory_io.h"

namespace plumbline {

/// @{
/// The numbers of an array or of nested sequences, row by row: of shape (N,), or (N, columns).
/// TypeError on anything but real numbers, ValueError on another shape. name: of the argument.
std::vector<double> NumbersOf(const std::string& name, const pybind11::object& values);
std::vector<double> RowsOf(const std::string& name, const pybind11::object& values, int columns);
/// @}

/// The same of shape (3, 3).
Eigen::Matrix3d MatrixOf(const std::string& name, const pybind11::object& values);

/// ValueError, with the first such row, if a number is not finite or beyond 1e8.
void CheckReach(const std::string& name, const std::vector<double>& values, int columns);

/// Poses with their times, from arrays of shapes (N,) and (N, 3); finite.
std::vector<TimedPose> TrajectoryOf(const pybind11::object& timestamps_s,
                                    const pybind11::object& poses);

/// An array that owns these numbers, of shape (N,), or (N, columns): nothing is copied.
template <typename T>
pybind11::array_t<T> ArrayOf(std::vector<T>&& values, int columns = 0) {
  auto owned = std::make_unique<std::vector<T>>(std::move(values));
  std::vector<pybind11::ssize_t> shape = {static_cast<pybind11::ssize_t>(owned->size())};
  if (columns > 0) shape = {shape[0] / columns, columns};
  T* data = owned->data();
  const pybind11::capsule owner(owned.get(),
                                [](void* vector) { delete static_cast<std::vector<T>*>(vector); });
  owned.release();  // NOLINT(bugprone-unused-return-value): the capsule has it
  return pybind11::array_t<T>(std::move(shape), data, owner);
}

/// The same of a copy.
template <typename T>
pybind11::array_t<T> ArrayOf(const std::vector<T>& values, int columns = 0) {
  return ArrayOf(std::vector<T>(values), columns);
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PYTHON_ARRAYS_H_
