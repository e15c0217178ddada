#include "plumbline/apps/benchmark/stage_profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "plumbline/core/thread_pool.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

LogProfile SmallProfile() {
  LogProfile profile;
  profile.machine = {2e9, 1e9};
  profile.num_returns = 1000000;
  // 40 MB take 20 ms.
  profile.stages = {{"reading", 0.1, 0.2, 4e7}, {"matching", 0.3, 0.3, 1.6e8}};
  return profile;
}

TEST(StageProfile, TheTableSaysHowFarAStageIsFromItsFloor) {
  const std::string table = ProfileTable(SmallProfile());
  EXPECT_THAT(table, HasSubstr("copies 2.0 GB/s"));
  EXPECT_THAT(table, HasSubstr("reading                     0.100   0.200   2.00      200"
                               "        200       40      20.0      5.0\n"));
  EXPECT_THAT(table, HasSubstr("all                         0.400   0.500   1.25      500"
                               "        500      200     100.0      4.0\n"));
}

TEST(StageProfile, TheFileHasALinePerStage) {
  const std::string path = TempFolder() + "profile.csv";
  ASSERT_TRUE(WriteProfileCsv(path, SmallProfile()).ok());
  EXPECT_EQ(ReadFile(path),
            "stage,returns,time_s,cpu_time_s,bytes,copied_bytes_per_s,multiply_adds_per_s\n"
            "\"reading\",1000000,0.1,0.2,40000000,2e+09,1e+09\n"
            "\"matching\",1000000,0.3,0.3,1.6e+08,2e+09,1e+09\n");
}

TEST(StageProfile, AMachineHasASpeed) {
  ThreadPool pool(2);
  const MachineSpeed speed = MeasureMachine(&pool);
  EXPECT_GT(speed.copied_bytes_per_s, 1e7);
  EXPECT_GT(speed.multiply_adds_per_s, 1e6);
}

}  // namespace
}  // namespace plumbline
