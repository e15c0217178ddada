#ifndef PLUMBLINE_APPS_PYTHON_FIELDS_H_
#define PLUMBLINE_APPS_PYTHON_FIELDS_H_

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "plumbline/apps/python/errors.h"

namespace plumbline {

/// "Name(field=value, ...)" of an object whose class has `_fields`, as those of Fields have.
std::string TextOfFields(const pybind11::object& object);

/// Sets fields of an object by their names; TypeError on a name that its class does not have.
void SetFields(const pybind11::object& object, const pybind11::kwargs& fields);

/// Adds to `_fields` of a class.
void AddFieldName(const pybind11::object& type, const char* name);

/// TypeError: the value does not fit a field that now has `present`.
[[noreturn]] void RaiseMisfit(const std::string& field, const pybind11::object& value,
                              const pybind11::object& present);

template <typename T>
struct IsVector : std::false_type {};
template <typename T>
struct IsVector<std::vector<T>> : std::true_type {};

/// Makes a struct of the library a class of Python, field by field. Sequences among the fields are
/// tuples of copies, so that nobody changes one in vain.
template <typename T>
class Fields {
 public:
  /// Of plain data: read only, made by the library.
  Fields(pybind11::module_* module, const char* name, const char* doc)
      : name_(name), class_(*module, name, doc) {
    class_.attr("_fields") = pybind11::tuple();
    class_.def("__repr__", [](const pybind11::object& self) { return TextOfFields(self); });
  }

  /// A constructor that takes fields by their names, and copies; of options with a Check the
  /// method check().
  Fields& Options() {
    namespace py = pybind11;
    class_.def(py::init([](const py::kwargs& fields) {
                 const py::object options = py::cast(T());
                 SetFields(options, fields);
                 return options.cast<T>();
               }),
               "Defaults, but for the fields that are given by name.");
    class_.def("__copy__", [](const T& self) { return T(self); });
    class_.def(
        "__deepcopy__", [](const T& self, const py::object&) { return T(self); }, py::arg("memo"));
    if constexpr (HasCheck(static_cast<T*>(nullptr))) {
      class_.def(
          "check", [](const T& self) { CheckOptions(self); },
          "Raises InvalidArgumentError, with name, value and bound, if a field is out of range.");
    }
    return *this;
  }

  /// A field that may be set.
  template <typename Value>
  Fields& Option(const char* name, Value T::*member, const char* doc) {
    return OptionBy(
        name, [member](T& self) -> Value& { return self.*member; }, doc);
  }

  /// The same of what `get` finds in the struct.
  template <typename Get>
  Fields& OptionBy(const char* name, Get get, const char* doc) {
    namespace py = pybind11;
    using Value = std::decay_t<decltype(get(std::declval<T&>()))>;
    const auto set = [get, field = std::string(name_) + "." + name](T& self,
                                                                    const py::object& value) {
      try {
        if (std::is_same_v<Value, bool> && !PyBool_Check(value.ptr())) throw py::cast_error();
        get(self) = value.cast<Value>();
      } catch (const py::cast_error&) {
        RaiseMisfit(field, value, py::cast(get(self)));
      }
    };
    AddName(name);
    if constexpr (IsVector<Value>::value) {
      class_.def_property(
          name, [get](T& self) { return py::tuple(py::cast(get(self))); }, set, doc);
    } else {
      class_.def_property(name, get, set, py::return_value_policy::reference_internal, doc);
    }
    return *this;
  }

  /// The same by functions of the struct.
  template <typename Get, typename Set>
  Fields& OptionOf(const char* name, Get get, Set set, const char* doc) {
    AddName(name);
    class_.def_property(name, get, set, doc);
    return *this;
  }

  /// A field to read.
  template <typename Value, typename Base>
  Fields& Field(const char* name, Value Base::*member, const char* doc = "") {
    AddName(name);
    if constexpr (IsVector<Value>::value) {
      class_.def_property_readonly(
          name, [member](const T& self) { return pybind11::tuple(pybind11::cast(self.*member)); },
          doc);
    } else {
      class_.def_readonly(name, member, doc);
    }
    return *this;
  }

  /// The same of what `get` makes of the struct.
  template <typename Get>
  Fields& FieldBy(const char* name, Get get, const char* doc = "") {
    AddName(name);
    class_.def_property_readonly(name, get, doc);
    return *this;
  }

  /// A constructor: pybind11::init, and what goes with it.
  template <typename Init, typename... Extra>
  Fields& Constructor(Init&& init, const Extra&... extra) {
    class_.def(std::forward<Init>(init), extra...);
    return *this;
  }

  /// A method.
  template <typename Function, typename... Extra>
  Fields& Method(const char* name, Function function, const Extra&... extra) {
    class_.def(name, function, extra...);
    return *this;
  }

  /// The same for one of the struct's. (pybind11 hands it a null pointer for None, and a reference
  /// refuses that.)
  template <typename Result, typename... Extra>
  Fields& Method(const char* name, Result (T::*function)() const, const Extra&... extra) {
    return Method(
        name, [function](const T& self) { return (self.*function)(); }, extra...);
  }

 private:
  template <typename U>
  static constexpr auto HasCheck(U* options) -> decltype(options->Check(nullptr), true) {
    return true;
  }
  static constexpr bool HasCheck(...) { return false; }

  void AddName(const char* name) { AddFieldName(class_, name); }

  const char* name_;
  pybind11::class_<T> class_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PYTHON_FIELDS_H_
