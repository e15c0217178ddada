#ifndef PLUMBLINE_CORE_OPTIONS_CHECK_H_
#define PLUMBLINE_CORE_OPTIONS_CHECK_H_

#include <cmath>
#include <sstream>
#include <string>

namespace plumbline {
namespace internal {

template <typename T>
bool FailOption(const char* name, const T& value, const char* requirement, std::string* error) {
  if (error != nullptr) {
    std::ostringstream text;
    text << name << " = " << value << ", but it must be " << requirement;
    *error = text.str();
  }
  return false;
}

template <typename Options>
bool CheckNestedOptions(const char* name, const Options& options, std::string* error) {
  if (options.Check(error)) return true;
  if (error != nullptr) error->insert(0, std::string(name) + ".");
  return false;
}

}  // namespace internal
}  // namespace plumbline

/// Inside `bool Check(std::string* error) const`: fails with field, value and bound unless
/// `field comparison bound` holds. A NaN fails every comparison.
#define PLUMBLINE_CHECK_OPTION(field, comparison, bound)                                      \
  do {                                                                                        \
    if (!((field)comparison(bound))) {                                                        \
      return ::plumbline::internal::FailOption(#field, field, #comparison " " #bound, error); \
    }                                                                                         \
  } while (false)

/// The same for a floating-point field that must also be finite.
#define PLUMBLINE_CHECK_FINITE_OPTION(field, comparison, bound)                 \
  do {                                                                          \
    PLUMBLINE_CHECK_OPTION(field, comparison, bound);                           \
    if (!std::isfinite(field)) {                                                \
      return ::plumbline::internal::FailOption(#field, field, "finite", error); \
    }                                                                           \
  } while (false)

/// Fails unless lowest <= field <= highest.
#define PLUMBLINE_CHECK_OPTION_WITHIN(field, lowest, highest) \
  do {                                                        \
    PLUMBLINE_CHECK_OPTION(field, >=, lowest);                \
    PLUMBLINE_CHECK_OPTION(field, <=, highest);               \
  } while (false)

/// The same for a field that has a Check of its own; the message then reads "field.its_field =
/// ...".
#define PLUMBLINE_CHECK_NESTED_OPTIONS(field)                                           \
  do {                                                                                  \
    if (!::plumbline::internal::CheckNestedOptions(#field, field, error)) return false; \
  } while (false)

#endif  // PLUMBLINE_CORE_OPTIONS_CHECK_H_
