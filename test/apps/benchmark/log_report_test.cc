#include "plumbline/apps/benchmark/log_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

LogExperiment OneStage() {
  LogExperiment experiment;
  LogStage stage;
  stage.name = "refined";
  stage.time_s = 77.5;
  stage.relations.emplace();
  stage.relations->all.num_matched = 3;
  stage.relations->all.translation_m.mean = 0.0303;
  stage.relations->all.translation_m.std = 0.0223;
  stage.raw_ranges.radii = {{0.1, {0.02, -4.0, 100}}};
  experiment.starts = {{"raw log", 5, 100, {stage}}};
  experiment.published = {{"other", "Someone 2001", {0.5, 0.25}, MeanAndStd{1.5, 2.5}},
                          {"third", "Else 2002", {0.75, 0.5}, {}}};
  return experiment;
}

TEST(LogReportTest, TablesHaveTheFiguresOfOthersAndTimes) {
  const std::string tables = LogTables(OneStage());
  EXPECT_THAT(tables, HasSubstr("0.0303 +- 0.0223"));
  EXPECT_THAT(tables, HasSubstr("other (Someone 2001)"));
  EXPECT_THAT(tables, HasSubstr("       0.50 +- 0.25          1.5 +- 2.5\n"));
  EXPECT_THAT(tables, HasSubstr("20.0   -4.000     77.50\n"));
}

TEST(LogReportTest, FilesHaveAllFiguresButNoTimes) {
  const std::string path = TempFolder() + "a";
  ASSERT_TRUE(WriteLogRelationsCsv(path, OneStage()).ok());
  const std::string relations = ReadFile(path);
  // What was not measured is empty.
  EXPECT_THAT(relations, HasSubstr("\n\"raw log\",\"refined\",all,0.0303,0.0223,,,3,0\n"));
  EXPECT_THAT(relations,
              HasSubstr("\n\"published, Someone 2001\",\"other\",all,0.5,0.25,1.5,2.5,,\n"));
  EXPECT_THAT(relations, HasSubstr("\n\"published, Else 2002\",\"third\",all,0.75,0.5,,,,\n"));
  ASSERT_TRUE(WriteLogSharpnessCsv(path, OneStage()).ok());
  EXPECT_THAT(ReadFile(path), HasSubstr("\n\"raw log\",\"refined\",raw_ranges,0.1,0.02,-4\n"));
  ASSERT_TRUE(WriteLogJson(path, OneStage()).ok());
  EXPECT_THAT(ReadFile(path), HasSubstr("\"Someone 2001\""));
  EXPECT_THAT(relations + ReadFile(path), Not(HasSubstr("77.5")));
}

TEST(LogReportTest, AMissingFolderIsUnavailable) {
  const std::string path = TempFolder() + "none/a";
  EXPECT_EQ(WriteLogRelationsCsv(path, OneStage()).code(), StatusCode::kUnavailable);
  EXPECT_EQ(WriteLogSharpnessCsv(path, OneStage()).code(), StatusCode::kUnavailable);
  EXPECT_EQ(WriteLogJson(path, OneStage()).code(), StatusCode::kUnavailable);
}

}  // namespace
}  // namespace plumbline
