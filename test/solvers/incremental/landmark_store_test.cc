#include "plumbline/solvers/incremental/landmark_store.h"

#include <gtest/gtest.h>

#include <numeric>
#include <tuple>
#include <vector>

#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/factors/factor_testing.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

constexpr int kNumPoses = 40;

std::vector<int> Range(int first, int end) {
  std::vector<int> range(end - first);
  std::iota(range.begin(), range.end(), first);
  return range;
}

// A drive around a room and a store of its landmarks.
struct StoredRoom {
  NoisyRoom room;
  MeasuredSurface surface;
  LineLandmarkOptions options;
  std::vector<PoseFrame> frames;
  LandmarkStore store;
  ThreadPool pool;
  const GemanMcClure loss = GemanMcClure::FromGate(3.0);

  explicit StoredRoom(int num_threads = 1)
      : room(MakeRoom()),
        surface(SurfaceOf(room.graph)),
        options(LandmarkOptionsFor(FactorOptions(), AssociationOptions())),
        frames(FramesOf(room.state.poses)),
        store(options),
        pool(num_threads) {
    store.Extend(room.graph);
    store.Reset(DominantDirection(room.graph, room.state.poses, surface, &pool));
  }

  static NoisyRoom MakeRoom() {
    NoisyRoomOptions options;
    options.num_poses = kNumPoses;
    return MakeNoisyRoom(options);
  }

  void Place(const std::vector<int>& poses) {
    store.Place(poses, room.graph, surface, frames, loss, &pool);
    store.Weigh(poses, room.graph, frames, loss, &pool);
  }
  void Displace(const std::vector<int>& poses, double sigma, RandomStates* random) {
    for (const int pose : poses) {
      Pose2 moved = room.state.WorldFromRobot(pose);
      moved.x += random->Gaussian(sigma);
      moved.y += random->Gaussian(sigma);
      moved.yaw += random->Gaussian(sigma);
      room.state.SetPose(pose, moved);
      frames[pose] = PoseFrame(moved);
    }
  }

  std::vector<LineLandmark> Lines() const {
    std::vector<LineLandmark> lines;
    for (const StoredLandmark& landmark : store.landmarks()) lines.push_back(landmark.line);
    return lines;
  }

  // What the store says of every return, summed up once more from all of them.
  void ExpectSumsOfReturns() {
    std::vector<int> all = Range(0, kNumPoses), placed;
    for (const int pose : all) {
      if (store.IsPlaced(pose)) placed.push_back(pose);
    }
    store.Weigh(placed, room.graph, frames, loss, &pool);
    ReturnCompressor compressor(room.graph, options.noise, &pool);
    LineObservations expected =
        compressor.LayOut(store.landmarks().size(), store.landmark_of_return());
    compressor.Weigh(Lines(), frames, loss, &expected);
    std::vector<std::vector<int>> landmarks_of_pose(kNumPoses);
    for (std::size_t id = 0; id < store.landmarks().size(); ++id) {
      const std::vector<StoredObservation>& stored = store.landmarks()[id].observations;
      const std::size_t first = expected.first_of_landmark[id];
      ASSERT_EQ(stored.size(), expected.first_of_landmark[id + 1] - first) << "landmark " << id;
      for (std::size_t i = 0; i < stored.size(); ++i) {
        const LineObservation& sum = expected.observations[first + i];
        const LineObservation& got = stored[i].moments;
        ASSERT_EQ(std::tie(got.pose, got.landmark), std::tie(sum.pose, sum.landmark));
        EXPECT_NEAR(got.weight, sum.weight, 1e-6 * sum.weight);
        EXPECT_LT((got.centroid() - sum.centroid()).norm(), 1e-5);
        EXPECT_NEAR(got.xx + got.yy, sum.xx + sum.yy, 1e-6 * (sum.xx + sum.yy) + 1e-6);
        landmarks_of_pose[got.pose].push_back(static_cast<int>(id));
      }
    }
    for (const int pose : all) EXPECT_EQ(store.LandmarksOfPose(pose), landmarks_of_pose[pose]);
  }
};

TEST(LandmarkStoreTest, AllPosesAtOnceGiveTheLandmarksOfABatch) {
  StoredRoom stored;
  stored.Place(Range(0, kNumPoses));
  const LineLandmarks batch = CutIntoLandmarks(stored.room.graph, stored.room.state.poses,
                                               stored.surface, stored.options, &stored.pool);
  const std::vector<LineLandmark> lines = stored.Lines();
  ASSERT_EQ(lines.size(), batch.landmarks.size());
  ASSERT_GT(lines.size(), 20u);
  for (std::size_t r = 0; r < stored.room.graph.num_returns(); ++r) {
    const int id = stored.store.landmark_of_return()[r];
    ASSERT_EQ(id == LineLandmarks::kNone, batch.landmark_of_return[r] == LineLandmarks::kNone) << r;
    if (id == LineLandmarks::kNone) continue;
    const LineLandmark& expected = batch.landmarks[batch.landmark_of_return[r]];
    EXPECT_LT((lines[id].origin - expected.origin).norm(), 1e-9);
    EXPECT_LT((lines[id].normal - expected.normal).norm(), 1e-9);
    EXPECT_NEAR(lines[id].offset_m, expected.offset_m, 1e-9);
  }
  stored.ExpectSumsOfReturns();
}

TEST(LandmarkStoreTest, PosesComeInTurnsAndMove) {
  StoredRoom stored;
  RandomStates random(3);
  for (int first = 0; first < kNumPoses; first += 8) {
    stored.Place(Range(first, first + 8));
    stored.ExpectSumsOfReturns();
    // Some move a little and keep their squares, some are placed anew, a step or a room away.
    stored.Displace(Range(0, first + 8), 0.005, &random);
    stored.ExpectSumsOfReturns();
    const std::vector<int> moved = Range(first / 2, first / 2 + 5);
    stored.Displace(moved, first % 16 == 0 ? 0.1 : 3.0, &random);
    stored.Place(moved);
    stored.ExpectSumsOfReturns();
  }
}

TEST(LandmarkStoreTest, AFewReturnsMoreJoinTheLandmarksThatAreThere) {
  StoredRoom stored;
  stored.Place(Range(0, kNumPoses - 1));
  const std::vector<LineLandmark> before = stored.Lines();
  stored.Place({kNumPoses - 1});
  const std::vector<LineLandmark> after = stored.Lines();
  std::size_t num_same = 0;
  for (std::size_t id = 0; id < before.size(); ++id) {
    num_same += before[id].normal == after[id].normal && before[id].offset_m == after[id].offset_m;
  }
  EXPECT_GT(num_same, 0.9 * static_cast<double>(before.size()));
  EXPECT_GT(stored.store.LandmarksOfPose(kNumPoses - 1).size(), 10u);
}

TEST(LandmarkStoreTest, ALineKeepsTheSideThatItWasSeenFrom) {
  StoredRoom stored;
  stored.Place(Range(0, kNumPoses));
  const LineLandmark before = stored.store.landmarks()[0].line;
  LineLandmark fitted = before;
  fitted.normal = -before.normal;
  fitted.offset_m = -before.offset_m;
  stored.store.SetLine(0, fitted);
  EXPECT_EQ(stored.store.landmarks()[0].line.normal, before.normal);
  EXPECT_EQ(stored.store.landmarks()[0].line.offset_m, before.offset_m);
}

TEST(LandmarkStoreTest, APoseWithAnotherScanIsNotPlacedYet) {
  StoredRoom stored;
  stored.Place(Range(0, kNumPoses));
  stored.room.graph.AddScanOf(stored.room.graph, 7, 5);
  stored.surface = SurfaceOf(stored.room.graph);
  stored.store.Extend(stored.room.graph);
  EXPECT_FALSE(stored.store.IsPlaced(5));
  EXPECT_TRUE(stored.store.LandmarksOfPose(5).empty());
  stored.Place({5});
  stored.ExpectSumsOfReturns();
}

TEST(LandmarkStoreTest, ResetForgetsAllLandmarks) {
  StoredRoom stored;
  stored.Place(Range(0, kNumPoses));
  stored.store.Reset(0.3);
  EXPECT_FALSE(stored.store.IsPlaced(0));
  EXPECT_TRUE(stored.store.landmarks().empty());
  stored.Place(Range(0, 10));
  stored.ExpectSumsOfReturns();
}

TEST(LandmarkStoreTest, TheResultDoesNotDependOnTheNumberOfThreads) {
  StoredRoom one(1), three(3);
  for (StoredRoom* stored : {&one, &three}) {
    RandomStates random(3);
    for (int first = 0; first < kNumPoses; first += 5) stored->Place(Range(first, first + 5));
    stored->Displace(Range(10, 30), 0.2, &random);
    stored->Place(Range(10, 30));
  }
  EXPECT_EQ(one.store.landmark_of_return(), three.store.landmark_of_return());
  ASSERT_EQ(one.store.landmarks().size(), three.store.landmarks().size());
  for (std::size_t id = 0; id < one.store.landmarks().size(); ++id) {
    const StoredLandmark &a = one.store.landmarks()[id], &b = three.store.landmarks()[id];
    EXPECT_EQ(a.line.offset_m, b.line.offset_m);
    ASSERT_EQ(a.observations.size(), b.observations.size());
    for (std::size_t i = 0; i < a.observations.size(); ++i) {
      EXPECT_EQ(a.observations[i].moments.weight, b.observations[i].moments.weight);
      EXPECT_EQ(a.observations[i].moments.center, b.observations[i].moments.center);
    }
  }
}

}  // namespace
}  // namespace plumbline
