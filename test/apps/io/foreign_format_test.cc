#include "plumbline/apps/io/foreign_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <string>

#include "plumbline/apps/program/read_log.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class ForeignFormatTest : public testing::Test {
 protected:
  // What the reader of the programs says.
  std::string Refusal(const std::string& name) const {
    SlamGraph graph;
    LogNotes notes;
    const Status status = ReadLogIntoGraph(folder_ + name, 0, &notes, &graph);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << name << ": " << status.message();
    return status.message();
  }
  void WriteGzip(const std::string& name, const std::string& content) const {
    const gzFile file = gzopen((folder_ + name).c_str(), "wb");
    gzwrite(file, content.data(), static_cast<unsigned>(content.size()));
    gzclose(file);
  }
  static std::string Content(const ForeignFormat& format, std::string_view start) {
    return std::string(format.start_at, 'x') + std::string(start) + " and so on\n";
  }

  const std::string folder_ = TempFolder();
};

TEST_F(ForeignFormatTest, EveryFormatIsToldByItsFirstBytes) {
  for (const ForeignFormat& format : ForeignFormats()) {
    for (const std::string_view start : format.starts) {
      SCOPED_TRACE(format.name);
      const std::string said = ": " + format.name + ", which is not read: " + format.advice;
      WriteGzip("a.log.gz", Content(format, start));
      EXPECT_EQ(Refusal("a.log.gz"), folder_ + "a.log.gz" + said);
      if (format.name == "a bag compressed by gzip") continue;  // a bag, without gzip
      WriteFile(folder_ + "a.log", Content(format, start));
      EXPECT_EQ(Refusal("a.log"), folder_ + "a.log" + said);
    }
  }
}

TEST_F(ForeignFormatTest, FilesOfMrptAreRefusedWithTheCommandsThatConvertThem) {
  WriteFile(folder_ + "a.rawlog",
            "\x91"
            "mrpt::obs::CActionCollection and so on");
  EXPECT_THAT(Refusal("a.rawlog"),
              testing::AllOf(HasSubstr("a rawlog of MRPT, which is not read: "),
                             HasSubstr("'rawlog-edit --export-2d-scans-txt -i FILE'"),
                             HasSubstr("'rawlog-edit --export-odometry-txt -i FILE'")));
  WriteFile(folder_ + "a.simplemap",
            "\x96"
            "mrpt::maps::CSimpleMap and so on");
  EXPECT_THAT(Refusal("a.simplemap"),
              testing::AllOf(HasSubstr("a map of MRPT (simplemap), which is not read: "),
                             HasSubstr("'sm-cli export-rawlog'"), HasSubstr("'rawlog-edit ")));
}

TEST_F(ForeignFormatTest, EveryFormatIsToldByTheEndingOfItsNameElse) {
  for (const ForeignFormat& format : ForeignFormats()) {
    for (const std::string& ending : format.endings) {
      const std::string path = folder_ + "a" + ending;
      const std::string said = format.name + " by its name, and no CARMEN log: " + format.advice;
      WriteFile(path, "nothing known\n");
      EXPECT_EQ(Refusal("a" + ending), path + ": " + said);
      WriteGzip("a" + ending + ".gz", "nothing known\n");
      EXPECT_EQ(Refusal("a" + ending + ".gz"), path + ".gz: " + said);
    }
  }
}

TEST_F(ForeignFormatTest, EveryFormatHasANameAndAdviceAndCanBeTold) {
  for (const ForeignFormat& format : ForeignFormats()) {
    EXPECT_FALSE(format.name.empty());
    EXPECT_FALSE(format.advice.empty()) << format.name;
    EXPECT_FALSE(format.starts.empty() && format.endings.empty()) << format.name;
    for (const std::string& ending : format.endings) EXPECT_THAT(ending, StartsWith("."));
  }
}

TEST_F(ForeignFormatTest, ALogOfAnyNameIsReadByItsContent) {
  for (const ForeignFormat& format : ForeignFormats()) {
    for (const std::string& ending : format.endings) {
      WriteFile(folder_ + "a" + ending,
                "# CARMEN Logfile\nFLASER 2 1 2 0 0 0 0 0 0 1.0 host 0\n"
                "FLASER 2 1 2 1 0 0 1 0 0 2.0 host 0\n");
      SlamGraph graph;
      LogNotes notes;
      EXPECT_TRUE(ReadLogIntoGraph(folder_ + "a" + ending, 0, &notes, &graph).ok()) << ending;
    }
  }
}

TEST_F(ForeignFormatTest, TheNameOfAPoseGraphDoesNotHideAPointerOfGitLfs) {
  WriteFile(folder_ + "a.g2o", "version https://git-lfs.github.com/spec/v1\noid sha256:0\n");
  EXPECT_THAT(Refusal("a.g2o"), HasSubstr("git lfs pull"));
}

TEST_F(ForeignFormatTest, WhatIsNotKnownIsRefusedAsBefore) {
  for (const char* content : {"", "ust", "nothing known\n"}) {
    WriteFile(folder_ + "a.log", content);
    EXPECT_THAT(Refusal("a.log"), StartsWith(folder_ + "a.log: no FLASER"));
  }
}

}  // namespace
}  // namespace plumbline
