#include "plumbline/apps/program/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <new>
#include <stdexcept>
#include <string>

namespace plumbline {
namespace {

using testing::EndsWith;
using testing::IsEmpty;

// What RunProgram leaves on standard error, and what it returns.
struct Ending {
  int exit_code = -1;
  std::string err;
};

Ending EndingOf(const Status& flags, const std::function<Status()>& run) {
  Ending ending;
  testing::internal::CaptureStderr();
  ending.exit_code = RunProgram(
      {}, [&flags] { return flags; }, run);
  ending.err = testing::internal::GetCapturedStderr();
  return ending;
}

TEST(CommandLineTest, TheExitCodeTellsTheKindOfFailure) {
  const auto exit_code = [](const Status& status) {
    const Ending ending = EndingOf(Status::Ok(), [&status] { return status; });
    EXPECT_THAT(ending.err, EndsWith(": " + status.message() + "\n"));
    return ending.exit_code;
  };
  EXPECT_EQ(exit_code(Status::InvalidArgument("a.log:1: wrong")), kExitBadInput);
  EXPECT_EQ(exit_code(Status::NotFound("no a.log")), kExitBadInput);
  EXPECT_EQ(exit_code(Status::DataLoss("a.log is cut")), kExitBadInput);
  EXPECT_EQ(exit_code(Status::Unavailable("disk full")), kExitCannotWrite);
}

TEST(CommandLineTest, WrongFlagsLetNothingRun) {
  bool ran = false;
  const Ending ending = EndingOf(Status::InvalidArgument("--log is missing"), [&ran] {
    ran = true;
    return Status::Ok();
  });
  EXPECT_EQ(ending.exit_code, kExitWrongUsage);
  EXPECT_THAT(ending.err, EndsWith(": --log is missing\n"));
  EXPECT_FALSE(ran);
}

TEST(CommandLineTest, FilesAreCheckedBeforeAnythingRuns) {
  const std::string path = "some_file";
  bool ran = false;
  testing::internal::CaptureStderr();
  const int exit_code = RunProgram(
      {{"log", &path, FileUse::kInput}, {"csv", &path, FileUse::kOutput}},
      [] { return Status::Ok(); },
      [&ran] {
        ran = true;
        return Status::Ok();
      });
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::HasSubstr(": --log and --csv both"));
  EXPECT_EQ(exit_code, kExitWrongUsage);
  EXPECT_FALSE(ran);
}

TEST(CommandLineTest, SaysNothingIfAllIsWell) {
  const Ending ending = EndingOf(Status::Ok(), [] { return Status::Ok(); });
  EXPECT_EQ(ending.exit_code, kExitDone);
  EXPECT_THAT(ending.err, IsEmpty());
}

TEST(CommandLineTest, ExceptionsEndInAMessage) {
  Ending ending = EndingOf(Status::Ok(), []() -> Status { throw std::bad_alloc(); });
  EXPECT_EQ(ending.exit_code, kExitBadInput);
  EXPECT_THAT(ending.err, EndsWith(": the input needs more memory than there is\n"));
  ending = EndingOf(Status::Ok(), []() -> Status { throw std::runtime_error("odd"); });
  EXPECT_EQ(ending.exit_code, kExitBadInput);
  EXPECT_THAT(ending.err, EndsWith(": odd\n"));
}

}  // namespace
}  // namespace plumbline
