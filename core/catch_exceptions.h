#ifndef PLUMBLINE_CORE_CATCH_EXCEPTIONS_H_
#define PLUMBLINE_CORE_CATCH_EXCEPTIONS_H_

#include <exception>
#include <new>
#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// Calls body, which gives a Status. What is thrown in there, by the library's own allocations or
/// by a callback of the user's, becomes Unavailable: nothing is thrown out of the library's doors.
template <typename Body>
Status CatchExceptions(const Body& body) {
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return Status::Unavailable("out of memory");
  } catch (const std::exception& exception) {
    return Status::Unavailable(std::string("an exception was thrown: ") + exception.what());
  } catch (...) {
    return Status::Unavailable("an exception was thrown that is no std::exception");
  }
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_CATCH_EXCEPTIONS_H_
