#include "plumbline/apps/python/errors.h"

#include <exception>
#include <utility>

#include "plumbline/apps/python/bindings.h"

namespace plumbline {
namespace py = pybind11;
namespace {

class StatusException : public std::exception {
 public:
  explicit StatusException(Status status) : status_(std::move(status)) {}
  const char* what() const noexcept override { return status_.message().c_str(); }
  const Status& status() const { return status_; }

 private:
  Status status_;
};

// The types of exceptions, which live as long as Python does.
struct ErrorTypes {
  py::handle invalid_argument, not_found, data_loss, unavailable;
};
ErrorTypes* Types() {
  static ErrorTypes types;
  return &types;
}

py::handle DefineError(const char* name, const char* doc, const py::tuple& bases,
                       py::module_* module) {
  const std::string full_name = std::string("plumbline.") + name;
  const py::handle type =
      PyErr_NewExceptionWithDoc(full_name.c_str(), doc, bases.ptr(), /*dict=*/nullptr);
  if (!type) throw py::error_already_set();
  module->add_object(name, type);
  return type;
}

py::handle TypeOf(StatusCode code) {
  switch (code) {
    case StatusCode::kNotFound:
      return Types()->not_found;
    case StatusCode::kDataLoss:
      return Types()->data_loss;
    case StatusCode::kUnavailable:
      return Types()->unavailable;
    case StatusCode::kOk:
    case StatusCode::kInvalidArgument:
      break;
  }
  return Types()->invalid_argument;
}

}  // namespace

py::str TextOf(const std::string& message) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeFSDefaultAndSize(message.data(), static_cast<py::ssize_t>(message.size())));
}

void RaiseIfError(const Status& status) {
  if (!status.ok()) throw StatusException(status);
}

void RaiseIfFailed(const SolverSummary& summary) {
  if (!summary.IsSolutionUsable()) RaiseIfError(Status::InvalidArgument(summary.message));
}

void CheckId(const char* kind, long long id, std::size_t size) {
  if (id >= 0 && static_cast<std::size_t>(id) < size) return;
  throw py::index_error(std::string("no ") + kind + " with id " + std::to_string(id) +
                        ", there are " + std::to_string(size));
}

void BindErrors(py::module_* module) {
  const auto base = py::reinterpret_borrow<py::object>(
      DefineError("Error", "What the library refuses or cannot do; the message names the culprit.",
                  py::make_tuple(py::handle(PyExc_Exception)), module));
  const auto define = [&](const char* name, const char* doc, PyObject* builtin) {
    return DefineError(name, doc, py::make_tuple(base, py::handle(builtin)), module);
  };
  *Types() = {
      define("InvalidArgumentError",
             "An input or an option is out of its range, or they do not go together.",
             PyExc_ValueError),
      define("NotFoundError", "A file does not exist.", PyExc_FileNotFoundError),
      define("DataLossError", "A file is damaged.", PyExc_ValueError),
      define("UnavailableError",
             "The system refused (permission, disk, memory), a callback stopped the work, or a "
             "computation came to no end.",
             PyExc_RuntimeError)};
  DefineError("InputWarning",
              "Something is skipped or doubtful in an input; `id` names the cause for scripts.",
              py::make_tuple(py::handle(PyExc_UserWarning)), module);
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const StatusException& exception) {
      PyErr_SetObject(TypeOf(exception.status().code()).ptr(), TextOf(exception.what()).ptr());
    }
  });
}

}  // namespace plumbline
