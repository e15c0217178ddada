#ifndef PLUMBLINE_TEST_CORE_CAPTURED_OUTPUT_H_
#define PLUMBLINE_TEST_CORE_CAPTURED_OUTPUT_H_

#include <gtest/gtest.h>

#include <string>

namespace plumbline {

/// Runs `function` and returns what this process wrote to standard output and standard error in the
/// meantime, whether through a stream or to the file descriptor.
template <typename Function>
std::string CapturedOutput(const Function& function) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  function();
  const std::string err = testing::internal::GetCapturedStderr();
  return testing::internal::GetCapturedStdout() + err;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_CORE_CAPTURED_OUTPUT_H_
