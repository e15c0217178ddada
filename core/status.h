#ifndef PLUMBLINE_CORE_STATUS_H_
#define PLUMBLINE_CORE_STATUS_H_

#include <string>
#include <utility>

namespace plumbline {

/// What kind of failure a Status stands for.
enum class StatusCode {
  kOk,               ///< No failure.
  kInvalidArgument,  ///< An input or option is outside its documented range.
  kNotFound,         ///< A file or an id does not exist.
  kDataLoss,         ///< A file is damaged beyond the accepted limit.
  /// The operating system refused (permission, disk full, memory), a callback stopped the work or
  /// threw, or a computation did not come to an end.
  kUnavailable,
};

/// Result of an operation on user input. On failure nothing was changed, and the message names the
/// culprit (file, line, field, or option).
class [[nodiscard]] Status {
 public:
  /// Success.
  Status() = default;
  /// Success.
  static Status Ok() { return Status(); }
  /// A failure of this kind; the message is for people.
  static Status InvalidArgument(std::string message) {
    return Status(StatusCode::kInvalidArgument, std::move(message));
  }
  /// See InvalidArgument.
  static Status NotFound(std::string message) {
    return Status(StatusCode::kNotFound, std::move(message));
  }
  /// See InvalidArgument.
  static Status DataLoss(std::string message) {
    return Status(StatusCode::kDataLoss, std::move(message));
  }
  /// See InvalidArgument.
  static Status Unavailable(std::string message) {
    return Status(StatusCode::kUnavailable, std::move(message));
  }

  /// Whether it went well.
  bool ok() const { return code_ == StatusCode::kOk; }
  /// The kind of failure.
  StatusCode code() const { return code_; }
  /// What went wrong, with names and numbers; empty if nothing did.
  const std::string& message() const { return message_; }

 private:
  Status(StatusCode code, std::string message) : code_(code), message_(std::move(message)) {}

  StatusCode code_ = StatusCode::kOk;
  std::string message_;
};

}  // namespace plumbline

/// Hands a failed Status on to the caller.
#define PLUMBLINE_RETURN_IF_ERROR(expression)            \
  do {                                                   \
    ::plumbline::Status plumbline_status = (expression); \
    if (!plumbline_status.ok()) return plumbline_status; \
  } while (false)

#endif  // PLUMBLINE_CORE_STATUS_H_
