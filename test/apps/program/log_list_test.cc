#include "plumbline/apps/program/log_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class LogListTest : public testing::Test {
 protected:
  LogListTest() {
    for (const char* name : {"a.clf", "b.clf", "a,b.clf"}) WriteFile(folder_ + name, "a log");
  }
  std::vector<std::string> Parse(const std::string& value) const {
    std::vector<std::string> logs;
    const Status status = ParseLogList(value, &logs);
    EXPECT_TRUE(status.ok()) << status.message();
    return logs;
  }
  void ExpectError(const std::string& value, StatusCode code, const std::string& message) const {
    std::vector<std::string> logs = {"as before"};
    const Status status = ParseLogList(value, &logs);
    EXPECT_EQ(status.code(), code);
    EXPECT_THAT(status.message(), HasSubstr(message));
    EXPECT_THAT(logs, ElementsAre("as before"));
  }
  std::string List(const std::string& text) const {
    WriteFile(folder_ + "logs.txt", text);
    return "@" + folder_ + "logs.txt";
  }

  const std::string folder_ = TempFolder();
};

TEST_F(LogListTest, TakesOneLogOrSeveral) {
  EXPECT_THAT(Parse("none.clf"), ElementsAre("none.clf"));
  EXPECT_THAT(Parse("c.clf,d.bag"), ElementsAre("c.clf", "d.bag"));
  EXPECT_THAT(Parse(folder_ + "a.clf," + folder_ + "b.clf"),
              ElementsAre(folder_ + "a.clf", folder_ + "b.clf"));
}

TEST_F(LogListTest, WhatIsThereIsOneLog) {
  EXPECT_THAT(Parse(folder_ + "a,b.clf"), ElementsAre(folder_ + "a,b.clf"));
  std::filesystem::create_directory(folder_ + "bag,1");
  EXPECT_THAT(Parse(folder_ + "bag,1"), ElementsAre(folder_ + "bag,1"));
}

TEST_F(LogListTest, ReadsAListWhosePathsStartAtItsFolder) {
  EXPECT_THAT(Parse(List("# of Monday\na.clf\r\n\n  sub/c d.bag \t\n/d.clf\n")),
              ElementsAre(folder_ + "a.clf", folder_ + "sub/c d.bag", "/d.clf"));
}

TEST_F(LogListTest, SaysWhatIsWrong) {
  ExpectError("", StatusCode::kInvalidArgument, "no log is named");
  ExpectError("a.clf,,b.clf", StatusCode::kInvalidArgument, "a name between commas is missing");
  ExpectError("a.clf,", StatusCode::kInvalidArgument, "a name between commas is missing");
  ExpectError("@" + folder_ + "none.txt", StatusCode::kNotFound, "none.txt");
  ExpectError(List("# nothing\n"), StatusCode::kInvalidArgument, "logs.txt: the list names no log");
  ExpectError("c.clf,c.clf", StatusCode::kInvalidArgument, "'c.clf' is named twice");
}

TEST_F(LogListTest, TellsLogsThatAreTheSameByAnyPath) {
  std::filesystem::create_symlink("a.clf", folder_ + "link.clf");
  ExpectError(folder_ + "a.clf," + folder_ + "link.clf", StatusCode::kInvalidArgument,
              "is named twice");
  ExpectError(List("a.clf\nb.clf\n./a.clf\n"), StatusCode::kInvalidArgument, "logs.txt, line 3: ");
}

TEST_F(LogListTest, KnowsAllFiles) {
  EXPECT_THAT(FilesOfLogList(List("a.clf\nb.clf\n")),
              ElementsAre(folder_ + "a.clf", folder_ + "b.clf", folder_ + "logs.txt"));
  EXPECT_THAT(FilesOfLogList("@none.txt"), ElementsAre("@none.txt", "none.txt"));
}

}  // namespace
}  // namespace plumbline
