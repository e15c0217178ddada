#include "plumbline/apps/run/checkpoint.h"

#include <gflags/gflags.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/run/flags.h"
#include "plumbline/test/core/temp_file.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

const RunFingerprint kFingerprint = {{"the checksum of the log", "77"}, {"--max_scans", "0"}};

// One of everything, and numbers that text would not keep.
SeedingReport MakeReport(const SlamGraph& graph) {
  const int num_poses = graph.num_poses();
  SeedingReport report;
  report.sequential.num_keyframes = 7;
  report.sequential.odometry_sign.sign_lost = true;
  report.odometry_noise.rotation = {true, 20, 0.0, 0.1 + 0.2};
  report.odometry_noise.motion.rotation_floor_rad = 5e-324;
  report.odometry_noise.clock_offset = {0.125, 1.0 / 3.0};
  report.loops.matches.push_back({1, 5, {0.1, 0.2, 0.3}, ClosureOutcome::kAmbiguous});
  report.loops.suspect_steps.push_back({5, 0.75, true, true, 0.25, 2, 3});
  WeighedHypothesis joined;
  joined.kind = HypothesisKind::kJoinedParts;
  joined.carried_to = {1.0, -2.0, 1.0 / 3.0};
  joined.first_pose_after = 4;
  joined.world_from_robot.assign(num_poses, {0.5, 0.25, 1.0 / 9.0});
  report.hypotheses = {WeighedHypothesis(), joined};
  report.consistency.worst_between = {{200, 50}, 3};
  report.consistency.places.push_back({2, 4, {0.5, -1.0 / 3.0}});
  report.pose_graph.push_back({0, 4, {1.0, 2.0, 3.0}, CorrelatedCovariance()});
  report.corrections.odometry.assign(graph.odometry().size(), {1.0 / 3.0, -0.0, 5e-324});
  report.moving_share = 1.0 / 11.0;
  report.corrections.moving_returns = {0, 7, graph.num_returns() - 1};
  report.sequential_poses.assign(num_poses, {1.0 / 7.0, 2.0, 3.0});
  report.alarm = true;
  return report;
}

class CheckpointTest : public testing::Test {
 protected:
  CheckpointTest()
      : graph_(MakeNoisyRoom().graph), seed_(graph_.initial_poses()), report_(MakeReport(graph_)) {
    for (double& value : seed_) value += 0.1;
  }

  void Write() const {
    const Status status = WriteCheckpoint(path_, kFingerprint, seed_, report_);
    ASSERT_TRUE(status.ok()) << status.message();
  }

  // The error of reading it, which must leave all as it was.
  Status ErrorOf(const RunFingerprint& fingerprint = kFingerprint) const {
    std::vector<double> poses = {1.0};
    SeedingReport report;
    const Status status = ReadCheckpoint(path_, fingerprint, graph_, &poses, &report);
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(poses, std::vector<double>{1.0});
    EXPECT_TRUE(report.sequential_poses.empty());
    return status;
  }

  const std::string folder_ = TempFolder(), path_ = folder_ + "seed.checkpoint";
  const SlamGraph graph_;
  std::vector<double> seed_;
  SeedingReport report_;
};

TEST_F(CheckpointTest, GivesBackTheSeedBitForBit) {
  Write();
  std::vector<double> poses;
  SeedingReport report;
  const Status status = ReadCheckpoint(path_, kFingerprint, graph_, &poses, &report);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(poses, seed_);
  ASSERT_EQ(report.corrections.odometry.size(), graph_.odometry().size());
  EXPECT_EQ(report.corrections.odometry[2].x, 1.0 / 3.0);
  EXPECT_EQ(report.corrections.moving_returns, report_.corrections.moving_returns);
  EXPECT_EQ(report.pose_graph[0].covariance, CorrelatedCovariance());
  EXPECT_EQ(report.consistency.places[0].world_point.y(), -1.0 / 3.0);
  EXPECT_EQ(report.loops.matches[0].outcome, ClosureOutcome::kAmbiguous);
  // And all the rest: written again it is the same file.
  ASSERT_TRUE(WriteCheckpoint(folder_ + "again", kFingerprint, poses, report).ok());
  EXPECT_TRUE(ReadFile(folder_ + "again") == ReadFile(path_));
}

TEST_F(CheckpointTest, NamesWhatDiffers) {
  Write();
  RunFingerprint other = kFingerprint;
  other[1].second = "50";
  Status status = ErrorOf(other);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("another run: --max_scans was 0, here it is 50"));
  other = kFingerprint;
  other.emplace_back("--new", "1");
  EXPECT_THAT(ErrorOf(other).message(), HasSubstr("--new was nothing, here it is 1"));
  other = kFingerprint;
  other.pop_back();
  EXPECT_THAT(ErrorOf(other).message(), HasSubstr("--max_scans was 0, here it is nothing"));
}

TEST_F(CheckpointTest, NoticesAnyDamage) {
  Write();
  const std::string whole = ReadFile(path_);
  for (std::size_t size = 0; size < whole.size(); size += size < 60 ? 1 : 97) {
    WriteFile(path_, whole.substr(0, size));
    EXPECT_NE(ErrorOf().code(), StatusCode::kUnavailable) << size;
  }
  for (std::size_t i = 0; i < whole.size(); i += i < 60 ? 1 : 89) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 4);
    WriteFile(path_, damaged);
    EXPECT_NE(ErrorOf().code(), StatusCode::kUnavailable) << i;
  }
  WriteFile(path_, whole.substr(0, whole.size() / 2));
  EXPECT_EQ(ErrorOf().code(), StatusCode::kDataLoss);
  EXPECT_THAT(ErrorOf().message(), HasSubstr(path_ + ": the checkpoint is damaged or cut off"));
}

TEST_F(CheckpointTest, RefusesOtherFiles) {
  EXPECT_EQ(ErrorOf().code(), StatusCode::kNotFound);
  WriteFile(path_, "FLASER 3 1 1 1 0 0 0\n");
  EXPECT_THAT(ErrorOf().message(), HasSubstr("is no checkpoint"));
  Write();
  std::string other = ReadFile(path_);
  other[other.find('\n') - 1] = 'x';
  WriteFile(path_, other);
  EXPECT_THAT(ErrorOf().message(), HasSubstr("another version"));
}

TEST_F(CheckpointTest, RefusesWhatIsNoFile) {
  std::filesystem::create_directory(path_);
  EXPECT_THAT(ErrorOf().message(), HasSubstr("cannot read '" + path_ + "': Is a directory"));
  std::filesystem::remove(path_);
  std::filesystem::create_symlink("/dev/zero", path_);
  EXPECT_THAT(ErrorOf().message(), HasSubstr("a pipe or a device, not a file"));
  std::filesystem::remove(path_);
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  EXPECT_THAT(ErrorOf().message(), HasSubstr("a pipe or a device, not a file"));
}

TEST_F(CheckpointTest, DoesNotTakeALargeFileOfAnotherKindIntoMemory) {
  WriteFile(path_, "no checkpoint");
  std::filesystem::resize_file(path_, std::uintmax_t{1} << 42);  // a hole, for the most part
  EXPECT_THAT(ErrorOf().message(), HasSubstr("is no checkpoint"));
}

TEST_F(CheckpointTest, RefusesAGraphOfAnotherSize) {
  NoisyRoomOptions options;
  options.num_poses = 9;
  const SlamGraph other = MakeNoisyRoom(options).graph;
  seed_ = other.initial_poses();
  Write();
  EXPECT_THAT(ErrorOf().message(), HasSubstr("field 'poses' has 27 entries, but the log needs 36"));
  seed_ = graph_.initial_poses();
  report_.corrections.odometry.resize(other.odometry().size());
  Write();
  EXPECT_THAT(
      ErrorOf().message(),
      HasSubstr("field 'seeding.corrections.odometry' has 8 entries, but the log needs 11"));
  report_ = MakeReport(graph_);
  report_.corrections.moving_returns.push_back(graph_.num_returns());
  Write();
  EXPECT_THAT(ErrorOf().message(), HasSubstr("field 'seeding.corrections.moving_returns' has " +
                                             std::to_string(graph_.num_returns())));
}

TEST_F(CheckpointTest, AFingerprintKnowsContentAndOptions) {
  const gflags::FlagSaver restore_flags;
  const std::string log = folder_ + "a.clf", copy = folder_ + "b.clf";
  WriteFile(log, "FLASER");
  WriteFile(copy, "FLASER");
  RunFingerprint first, second;
  LogStamp stamp;
  ASSERT_TRUE(FingerprintOfRun(log, &first, &stamp).ok());
  SolverOptions options;
  ASSERT_TRUE(SolverOptionsFromFlags(&options).ok());  // the flags are there
  gflags::SetCommandLineOption("threads", "7");
  ASSERT_TRUE(FingerprintOfRun(copy, &second, &stamp).ok());
  EXPECT_EQ(first, second);
  WriteFile(copy, "FLASEr");
  ASSERT_TRUE(FingerprintOfRun(copy, &second, &stamp).ok());
  EXPECT_NE(first, second);
  gflags::SetCommandLineOption("sigma_range_m", "0.0125");
  ASSERT_TRUE(FingerprintOfRun(log, &second, &stamp).ok());
  EXPECT_NE(first, second);
  EXPECT_EQ(FingerprintOfRun(folder_ + "none", &second, &stamp).code(), StatusCode::kNotFound);
}

TEST_F(CheckpointTest, AFingerprintKnowsWhatSqliteKeepsBesideALog) {
  const std::string log = folder_ + "a.db3";
  WriteFile(log, "main");
  RunFingerprint first, second;
  LogStamp stamp;
  ASSERT_TRUE(FingerprintOfRun(log, &first, &stamp).ok());
  WriteFile(log + "-wal", "more");
  EXPECT_FALSE(CheckUnchanged(log, stamp).ok());
  ASSERT_TRUE(FingerprintOfRun(log, &second, &stamp).ok());
  EXPECT_NE(first, second);
}

TEST_F(CheckpointTest, ALogWithAnotherInItsPlaceHasChanged) {
  const std::string log = folder_ + "a.clf", other = folder_ + "b.clf";
  WriteFile(log, "FLASER");
  WriteFile(other, "FLASEr");
  const auto time = std::filesystem::last_write_time(log);
  RunFingerprint fingerprint;
  LogStamp stamp;
  ASSERT_TRUE(FingerprintOfRun(log, &fingerprint, &stamp).ok());
  EXPECT_TRUE(CheckUnchanged(log, stamp).ok());
  std::filesystem::last_write_time(other, time);
  std::filesystem::rename(other, log);
  EXPECT_EQ(CheckUnchanged(log, stamp).message(), log + ": the log changed while it was read");
  std::filesystem::remove(log);
  EXPECT_EQ(CheckUnchanged(log, stamp).code(), StatusCode::kNotFound);
}

TEST_F(CheckpointTest, AFingerprintRefusesAPipe) {
  const std::string log = folder_ + "a.clf";
  ASSERT_EQ(mkfifo(log.c_str(), 0600), 0);
  RunFingerprint fingerprint;
  LogStamp stamp;
  EXPECT_THAT(FingerprintOfRun(log, &fingerprint, &stamp).message(),
              HasSubstr("a pipe or a device, not a file"));
}

}  // namespace
}  // namespace plumbline
