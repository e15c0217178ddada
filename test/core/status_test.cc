#include "plumbline/core/status.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(Status, OkByDefault) {
  EXPECT_TRUE(Status().ok());
  EXPECT_TRUE(Status::Ok().ok());
  EXPECT_EQ(Status::Ok().code(), StatusCode::kOk);
  EXPECT_EQ(Status::Ok().message(), "");
}

TEST(Status, FailuresKeepCodeAndMessage) {
  const auto expect = [](const Status& status, StatusCode code) {
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(status.code(), code);
    EXPECT_EQ(status.message(), "line 7");
  };
  expect(Status::InvalidArgument("line 7"), StatusCode::kInvalidArgument);
  expect(Status::NotFound("line 7"), StatusCode::kNotFound);
  expect(Status::DataLoss("line 7"), StatusCode::kDataLoss);
  expect(Status::Unavailable("line 7"), StatusCode::kUnavailable);
}

TEST(Status, ReturnIfErrorEvaluatesOnceAndStopsAtAFailure) {
  int calls = 0;
  bool went_on = false;
  const auto run = [&](const Status& status) -> Status {
    const auto step = [&] {
      ++calls;
      return status;
    };
    PLUMBLINE_RETURN_IF_ERROR(step());
    went_on = true;
    return Status::Ok();
  };

  EXPECT_EQ(run(Status::DataLoss("torn")).message(), "torn");
  EXPECT_FALSE(went_on);
  EXPECT_TRUE(run(Status::Ok()).ok());
  EXPECT_TRUE(went_on);
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace plumbline
