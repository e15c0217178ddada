#include "plumbline/core/catch_exceptions.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>

namespace plumbline {
namespace {

TEST(CatchExceptions, HandsOnWhatTheBodySays) {
  EXPECT_TRUE(CatchExceptions([] { return Status::Ok(); }).ok());
  const Status status = CatchExceptions([] { return Status::NotFound("no such pose"); });
  EXPECT_EQ(status.code(), StatusCode::kNotFound);
  EXPECT_EQ(status.message(), "no such pose");
}

TEST(CatchExceptions, TurnsWhatIsThrownIntoAStatus) {
  const Status error =
      CatchExceptions([]() -> Status { throw std::runtime_error("no more paper"); });
  EXPECT_EQ(error.code(), StatusCode::kUnavailable);
  EXPECT_EQ(error.message(), "an exception was thrown: no more paper");
  EXPECT_EQ(CatchExceptions([]() -> Status { throw std::bad_alloc(); }).message(), "out of memory");
  EXPECT_EQ(CatchExceptions([]() -> Status { throw 7; }).code(), StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
