#include "plumbline/apps/benchmark/replay_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(ReplayReportTest, TableFilesAndChart) {
  Replay replay;
  replay.steps = {{1, 100, ReplayedSolve::kWindow, 0, 0, 100, 0.1, 20.0, 10.0},
                  {2, 200, ReplayedSolve::kWindow, 1, 0, 120, 0.3, 20.0, 10.0},
                  {3, 300, ReplayedSolve::kLoops, 5, 2, 300, 0.9, 90.0, 30.0},
                  {3, 300, ReplayedSolve::kFinal, 5, 0, 0, 0.5, 33.0, 30.3}};
  replay.batch_energy = 30.0;
  replay.online_energy = 33.0;
  replay.final_energy = 30.3;
  replay.online_difference = {0.0012, 0.0123, 0.0045};
  replay.final_difference = {0.001, 0.002, 0.003};
  const std::string table = ReplayTable(replay);
  EXPECT_THAT(table,
              HasSubstr("window           2       0.300       0.300       0.300           220\n"));
  EXPECT_THAT(table,
              HasSubstr("loops            1       0.900       0.900       0.900           300\n"));
  EXPECT_THAT(table,
              HasSubstr("online           3       0.300       0.900       0.900           520\n"));
  EXPECT_THAT(table, HasSubstr("after the final solve 30.3 (+1.0 %), all at once 30.0"));
  EXPECT_THAT(table, HasSubstr("online: 1.200 mm from all at once in the mean, 12.300 mm at most; "
                               "a step turned by 4.500 mrad at most\n"));
  EXPECT_THAT(table, HasSubstr("after the final solve: 1.000 mm from all at once"));

  const std::string folder = TempFolder();
  ASSERT_TRUE(WriteReplayCsv(folder + "replay.csv", replay).ok());
  EXPECT_EQ(ReadFile(folder + "replay.csv"),
            "batch,poses,solve,closures,news,placed,time_s,initial_energy,final_energy\n"
            "1,100,window,0,0,100,0.1,20,10\n"
            "2,200,window,1,0,120,0.3,20,10\n"
            "3,300,loops,5,2,300,0.9,90,30\n"
            "3,300,final,5,0,0,0.5,33,30.3\n");
  ASSERT_TRUE(WriteReplayChart(folder + "replay.png", replay).ok());
  EXPECT_THAT(ReadFile(folder + "replay.png"), StartsWith("\x89PNG"));
  EXPECT_FALSE(WriteReplayCsv(folder + "none/replay.csv", replay).ok());
  EXPECT_FALSE(WriteReplayChart(folder + "none/replay.png", replay).ok());
}

}  // namespace
}  // namespace plumbline
