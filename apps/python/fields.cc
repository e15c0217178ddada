#include "plumbline/apps/python/fields.h"

#include <pybind11/numpy.h>

namespace plumbline {
namespace py = pybind11;
namespace {

std::string NameOfType(const py::handle& object) {
  return py::str(py::type::of(object).attr("__name__"));
}

// Long sequences by their sizes.
std::string TextOfValue(const py::handle& value) {
  constexpr std::size_t kMostElements = 4;
  if (py::isinstance<py::array>(value)) {
    return "<array of shape " + static_cast<std::string>(py::str(value.attr("shape"))) + ">";
  }
  const bool is_sequence = py::isinstance<py::tuple>(value) || py::isinstance<py::list>(value);
  if (is_sequence && py::len(value) > kMostElements) {
    return "<" + std::to_string(py::len(value)) + " of " +
           NameOfType(value[py::int_(0)].cast<py::object>()) + ">";
  }
  return py::repr(value);
}

}  // namespace

std::string TextOfFields(const py::object& object) {
  std::string text = NameOfType(object) + "(";
  const char* separator = "";
  for (const py::handle name : object.attr("_fields")) {
    text += separator + name.cast<std::string>() + "=" + TextOfValue(py::getattr(object, name));
    separator = ", ";
  }
  return text + ")";
}

void SetFields(const py::object& object, const py::kwargs& fields) {
  for (const auto& [name, value] : fields) {
    if (!object.attr("_fields").contains(name)) {
      throw py::type_error(NameOfType(object) + " has no field '" + name.cast<std::string>() + "'");
    }
    py::setattr(object, name, value);
  }
}

void AddFieldName(const py::object& type, const char* name) {
  const py::object names = type.attr("_fields");
  type.attr("_fields") = names + py::make_tuple(name);
}

void RaiseMisfit(const std::string& field, const py::object& value, const py::object& present) {
  throw py::type_error(field + ": " + static_cast<std::string>(py::repr(value)) +
                       " does not fit, it takes a value of type " + NameOfType(present));
}

}  // namespace plumbline
