#include "plumbline/apps/benchmark/synthetic_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

// Of the published method, which takes its time.
MapLogOptions FewPasses() {
  MapLogOptions options;
  options.solver.published.max_passes = 2;
  return options;
}

using testing::ContainsRegex;
using testing::HasSubstr;

class SyntheticReportTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    ThreadPool pool(2);
    outcomes_ = new std::vector<SyntheticOutcome>();
    ASSERT_TRUE(RunSyntheticExperiment(2, Noises(), FewPasses(), &pool, outcomes_).ok());
  }
  static void TearDownTestSuite() { delete outcomes_; }

  static std::vector<SyntheticNoise> Noises() { return {{"loud", 0.04, 0.002, 1.5}}; }

  const std::string folder_ = TempFolder();
  static std::vector<SyntheticOutcome>* outcomes_;
};
std::vector<SyntheticOutcome>* SyntheticReportTest::outcomes_ = nullptr;

TEST_F(SyntheticReportTest, TableNamesNoiseFailuresAndPublishedFigures) {
  const std::string table = SyntheticTable(Noises(), *outcomes_);
  EXPECT_THAT(table, HasSubstr("loud: range 40 mm, bearing 0.114592 deg, odometry x 1.5"));
  EXPECT_THAT(table, HasSubstr("2 of 2\n"));  // the odometry
  // The paper's figures are beside the rows that it has.
  EXPECT_THAT(table, ContainsRegex("ICP .Besl & McKay. .* 0.597 0.199 .* 0.702 0.238 "));
  EXPECT_THAT(table, ContainsRegex("SG .Olson. .* 0.088 0.115 .* 0.115 0.005 "));
  EXPECT_THAT(table, ContainsRegex("\n  published  .* 0.035 0.048 .* 0.047 0.002 "));
  EXPECT_THAT(table, HasSubstr("The gates of ICP and SG, 1.8 and 0.5 m, "));
}

TEST_F(SyntheticReportTest, CsvHasOneRowPerSeedAndMapper) {
  ASSERT_TRUE(WriteSyntheticCsv(folder_ + "a.csv", Noises(), *outcomes_).ok());
  const std::string csv = ReadFile(folder_ + "a.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * kNumMappers);
  EXPECT_THAT(csv, HasSubstr("\n2,0.04,0.002,1.5,\"Plumbline\","));
}

TEST_F(SyntheticReportTest, JsonHoldsTheMedians) {
  ASSERT_TRUE(WriteSyntheticJson(folder_ + "a.json", Noises(), *outcomes_).ok());
  const auto json = nlohmann::json::parse(ReadFile(folder_ + "a.json"));
  ASSERT_EQ(json["noise_levels"].size(), 1u);
  const auto& rows = json["noise_levels"][0]["algorithms"];
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(kNumMappers));
  const SyntheticSummary summary = SummariseOutcomes(*outcomes_)[2];
  EXPECT_EQ(rows[2]["algorithm"], "published");
  EXPECT_EQ(rows[2]["pose_error_mean_m"]["median"], summary.pose_mean_m.median);
  ASSERT_EQ(json["published"].size(), 3u);
  EXPECT_EQ(json["published"][1]["algorithm"], "SG (Olson)");
  EXPECT_EQ(json["published"][1]["map_error_variance"], 0.005);
}

TEST_F(SyntheticReportTest, PicturesAreTheSameEachTime) {
  for (const std::string name : {"a.png", "b.png"}) {
    ASSERT_TRUE(WritePoseErrorChart(folder_ + "pose_" + name, Noises()[0], 0, *outcomes_).ok());
    ASSERT_TRUE(WriteMapErrorChart(folder_ + "map_" + name, Noises()[0], 0, *outcomes_).ok());
    ASSERT_TRUE(WriteSyntheticMaps(folder_ + "maps_" + name, 1, Noises()[0], FewPasses()).ok());
  }
  for (const std::string kind : {"pose_", "map_", "maps_"}) {
    const std::string picture = ReadFile(folder_ + kind + "a.png");
    EXPECT_GT(picture.size(), 10000u);
    EXPECT_EQ(picture, ReadFile(folder_ + kind + "b.png"));
  }
  EXPECT_NE(ReadFile(folder_ + "pose_a.png"), ReadFile(folder_ + "map_a.png"));
}

TEST_F(SyntheticReportTest, RefusesAFolderThatIsNotThere) {
  const std::string path = folder_ + "missing/a";
  EXPECT_EQ(WriteSyntheticCsv(path, Noises(), *outcomes_).code(), StatusCode::kUnavailable);
  EXPECT_EQ(WriteSyntheticJson(path, Noises(), *outcomes_).code(), StatusCode::kUnavailable);
  EXPECT_FALSE(WritePoseErrorChart(path, Noises()[0], 0, *outcomes_).ok());
}

}  // namespace
}  // namespace plumbline
