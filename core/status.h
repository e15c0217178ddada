#ifndef PLUMBLINE_CORE_STATUS_H_
#define PLUMBLINE_CORE_STATUS_H_

#include <string>
#include <utility>

namespace plumbline {

enum class StatusCode {
  kOk,
  kInvalidArgument,  ///< An input or option is outside its documented range.
  kNotFound,         ///< A file or an id does not exist.
  kDataLoss,         ///< A file is damaged beyond the accepted limit.
  kUnavailable,      ///< The operating system refused (permission, disk full).
};

/// Result of an operation on user input. On failure nothing was changed, and the message names the
/// culprit (file, line, field, or option).
class [[nodiscard]] Status {
 public:
  Status() = default;
  static Status Ok() { return Status(); }
  static Status InvalidArgument(std::string message) {
    return Status(StatusCode::kInvalidArgument, std::move(message));
  }
  static Status NotFound(std::string message) {
    return Status(StatusCode::kNotFound, std::move(message));
  }
  static Status DataLoss(std::string message) {
    return Status(StatusCode::kDataLoss, std::move(message));
  }
  static Status Unavailable(std::string message) {
    return Status(StatusCode::kUnavailable, std::move(message));
  }

  bool ok() const { return code_ == StatusCode::kOk; }
  StatusCode code() const { return code_; }
  const std::string& message() const { return message_; }

 private:
  Status(StatusCode code, std::string message) : code_(code), message_(std::move(message)) {}

  StatusCode code_ = StatusCode::kOk;
  std::string message_;
};

}  // namespace plumbline

/// Hands a failed Status on to the caller.
#define PLUMBLINE_RETURN_IF_ERROR(expression)                  \
  do {                                                         \
    const ::plumbline::Status plumbline_status = (expression); \
    if (!plumbline_status.ok()) return plumbline_status;       \
  } while (false)

#endif  // PLUMBLINE_CORE_STATUS_H_
