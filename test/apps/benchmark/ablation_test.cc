#include "plumbline/apps/benchmark/ablation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>

#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

AblationInput Room() {
  NoisyRoomOptions options;
  options.num_poses = 24;
  NoisyRoom room = MakeNoisyRoom(options);
  AblationInput input;
  for (const Pose2& pose : room.truth) input.truth.poses.push_back(Between(room.truth[0], pose));
  input.seed.poses = PoseArray(input.truth.poses);
  input.truth.points = room.graph.MeasuredMap(input.seed.poses);
  DisturbPoses(0.02, room.graph, &input.seed);
  input.graph = std::move(room.graph);
  input.full.num_threads = 1;
  return input;
}

TEST(Ablation, EachVariantIsValidAndDiffersByName) {
  std::set<std::string> names;
  for (const AblationVariant& variant : AblationVariants(SolverOptions())) {
    std::string error;
    EXPECT_TRUE(variant.options.Check(&error)) << variant.name << ": " << error;
    names.insert(variant.name);
  }
  EXPECT_EQ(names.size(), AblationVariants(SolverOptions()).size());
}

TEST(Ablation, TheManifoldPotentialIsWhatMakesTheMap) {
  const AblationInput input = Room();
  ThreadPool pool(1);
  std::vector<AblationOutcome> outcomes;
  ASSERT_TRUE(RunAblation(input, &pool, &outcomes).ok());
  const std::vector<AblationVariant> variants = AblationVariants(input.full);
  ASSERT_EQ(outcomes.size(), variants.size() + 1);
  const auto of = [&](const std::string& name) {
    for (std::size_t i = 0; i < variants.size(); ++i) {
      if (variants[i].name == name) return outcomes[i + 1];
    }
    ADD_FAILURE() << name;
    return AblationOutcome();
  };
  const AblationOutcome& seed = outcomes[0];
  const AblationOutcome full = of("full");
  EXPECT_LT(full.pose_m, 0.5 * seed.pose_m);
  EXPECT_LT(full.energy, seed.energy);
  EXPECT_LT(full.thickness_m, seed.thickness_m);
  EXPECT_TRUE(std::isnan(full.relations_m));
  EXPECT_GT(of("no manifold potential").energy, full.energy);
  EXPECT_GT(of("no manifold potential").thickness_m, full.thickness_m);
  // Rounds end within this share of the energy.
  EXPECT_GE(of("lines fixed within a round").energy,
            (1.0 - ReducedOptions().relative_tolerance) * full.energy);
}

TEST(Ablation, TableAndFilesHoldMediansAndLeaveOutWhatIsUnknown) {
  AblationTable table{"rooms", {"seed", "full"}, {}};
  for (const double pose_m : {0.001, 0.005, 0.002}) {
    AblationOutcome seed, full;
    seed.pose_m = 0.1;
    full.pose_m = pose_m;
    table.outcomes.push_back({seed, full});
  }
  const std::string text = AblationText(table);
  EXPECT_THAT(text, testing::HasSubstr("rooms, medians over 3"));
  EXPECT_THAT(text, testing::ContainsRegex("full +2.00 +-"));
  const std::string folder = TempFolder();
  ASSERT_TRUE(WriteAblationCsv(folder + "a.csv", {table}).ok());
  const std::string csv = ReadFile(folder + "a.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
  EXPECT_THAT(csv, testing::HasSubstr("\"rooms\",2,\"full\",0.005,,,,,,\n"));
  ASSERT_TRUE(WriteAblationJson(folder + "a.json", {table}).ok());
  EXPECT_THAT(ReadFile(folder + "a.json"), testing::HasSubstr("\"pose_error_m\": 0.002"));
  EXPECT_EQ(WriteAblationCsv(folder + "missing/a", {table}).code(), StatusCode::kUnavailable);
}

TEST(Ablation, IsTheSameOnAnyNumberOfThreads) {
  ThreadPool one(1), two(2);
  SolverOptions few;
  few.published.max_passes = 3;
  AblationTable expected, table;
  ASSERT_TRUE(AblateSyntheticDrives(2, few, &one, &expected).ok());
  ASSERT_TRUE(AblateSyntheticDrives(2, few, &two, &table).ok());
  EXPECT_EQ(table.names, expected.names);
  for (std::size_t i = 0; i < table.outcomes.size(); ++i) {
    for (std::size_t row = 0; row < table.names.size(); ++row) {
      EXPECT_EQ(table.outcomes[i][row].pose_m, expected.outcomes[i][row].pose_m);
      EXPECT_EQ(table.outcomes[i][row].energy, expected.outcomes[i][row].energy);
    }
  }
}

}  // namespace
}  // namespace plumbline
