#include "plumbline/solvers/landmarks/line_observations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "plumbline/solvers/association/held_out_returns.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

constexpr int kNumLandmarks = 9;

/// Returns of two lasers on a robot at many poses: the scans of a pose are not side by side, and
/// every fifth pose has none. The landmark of a return is drawn by lot; some have none, and one
/// landmark is never seen.
struct Sighted {
  SlamGraph graph;
  MeasuredSurface surface;
  std::vector<int> landmark_of_return;
  std::vector<LineLandmark> landmarks;
  FactorOptions factors;

  explicit Sighted(int num_poses = 150) {
    RandomStates random(23);
    constexpr int kNumBeams = 30;
    LaserModel lasers[2] = {PanoramicLaser(kNumBeams), PanoramicLaser(kNumBeams)};
    lasers[0].robot_from_laser = {0.3, 0.1, 0.2};
    lasers[1].robot_from_laser = {-0.5, 0.0, kPi};
    int ids[2];
    for (int i = 0; i < 2; ++i) ids[i] = graph.AddLaser(lasers[i]);
    for (int i = 0; i < num_poses; ++i) graph.AddPose(random.Pose(), i);
    for (int sweep = 0; sweep < 3; ++sweep) {
      for (int i = num_poses; i-- > 0;) {
        if (i % 5 == 4) continue;
        std::vector<double> ranges(kNumBeams);
        for (double& range : ranges) range = random.Uniform(0.2, 12.0);
        graph.AddScan(i, ids[(sweep + i) % 2], ranges);
      }
    }
    ThreadPool pool(1);
    surface = MeasureSurface(graph, ReturnNormalOptions(), &pool);
    for (std::size_t r = 0; r < graph.num_returns(); ++r) {
      const int lot = static_cast<int>(random.Uniform(-2, kNumLandmarks - 1));
      landmark_of_return.push_back(lot < 0 ? LineLandmarks::kNone : lot + (lot >= 4));
    }
    landmarks = RandomLines(&random);
    factors.manifold.sigma_m = 0.3;
  }

  static std::vector<LineLandmark> RandomLines(RandomStates* random) {
    std::vector<LineLandmark> lines(kNumLandmarks);
    for (LineLandmark& line : lines) {
      line.origin = {random->Uniform(-3, 3), random->Uniform(-3, 3)};
      line.normal = random->Direction();
      line.offset_m = random->Uniform(-0.5, 0.5);
    }
    return lines;
  }

  int PoseOf(std::size_t r) const { return graph.scan(graph.ScanOfReturn(r)).pose; }

  /// Signed distance [m] of a return from its landmark's line.
  double Distance(std::size_t r, const std::vector<LineLandmark>& lines,
                  const std::vector<double>& poses) const {
    const LineLandmark& line = lines[landmark_of_return[r]];
    const Eigen::Vector2d point = Pose2(&poses[3 * PoseOf(r)]) * graph.PointInRobot(r);
    return line.normal.dot(point - line.origin) - line.offset_m;
  }

  /// sigma_M^2 + n^T C n [m^2], C from the beam as the graph has it.
  double Variance(std::size_t r) const {
    const int scan = graph.ScanOfReturn(r);
    const double bearing = graph.WorldFromLaser(scan, graph.initial_poses()).yaw + graph.Bearing(r);
    const Eigen::Vector2d axis(std::cos(bearing), std::sin(bearing)), side(-axis.y(), axis.x());
    const Eigen::Vector2d& normal = landmarks[landmark_of_return[r]].normal;
    return std::pow(factors.manifold.sigma_m, 2) +
           std::pow(factors.beam.sigma_range_m * axis.dot(normal), 2) +
           std::pow(factors.beam.sigma_bearing_rad * graph.returns().range_m[r] * side.dot(normal),
                    2);
  }

  double Weight(std::size_t r, const GemanMcClure& loss) const {
    const double variance = Variance(r);
    const double distance = Distance(r, landmarks, graph.initial_poses());
    return loss.Weight(distance * distance / variance) / variance;
  }
};

LineObservations LayOutAndWeigh(const Sighted& sighted, const GemanMcClure& loss, ThreadPool* pool,
                                double* cost) {
  ReturnCompressor compressor(sighted.graph, NoiseOf(sighted.factors), pool);
  LineObservations observations = compressor.LayOut(kNumLandmarks, sighted.landmark_of_return);
  *cost = compressor.Weigh(sighted.landmarks, FramesOf(sighted.graph.initial_poses()), loss,
                           &observations);
  return observations;
}

void ExpectSameBits(const LineObservation& a, const LineObservation& b) {
  EXPECT_EQ(a.weight, b.weight);
  EXPECT_EQ(a.center, b.center);
  EXPECT_EQ(a.xx, b.xx);
  EXPECT_EQ(a.xy, b.xy);
  EXPECT_EQ(a.yy, b.yy);
}

TEST(LineObservationsTest, FramesAreThePoses) {
  RandomStates random(2);
  std::vector<double> poses;
  for (int i = 0; i < 3; ++i) {
    const std::vector<double> block = ToBlock(random.Pose());
    poses.insert(poses.end(), block.begin(), block.end());
  }
  const std::vector<PoseFrame> frames = FramesOf(poses);
  ASSERT_EQ(frames.size(), 3u);
  const Eigen::Vector2d v(0.3, -1.2);
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2d moved = Pose2(&poses[3 * i]) * v;
    EXPECT_LT((frames[i].Rotate(v) + frames[i].translation() - moved).norm(), 1e-14);
    EXPECT_LT((frames[i].RotateBack(frames[i].Rotate(v)) - v).norm(), 1e-14);
  }
}

TEST(LineObservationsTest, ListsEachPairOfPoseAndLandmarkOnce) {
  const Sighted sighted;
  ThreadPool pool(2);
  ReturnCompressor compressor(sighted.graph, NoiseOf(sighted.factors), &pool);
  const LineObservations observations =
      compressor.LayOut(kNumLandmarks, sighted.landmark_of_return);
  std::set<std::pair<int, int>> expected;  // landmark, pose
  for (std::size_t r = 0; r < sighted.graph.num_returns(); ++r) {
    const int landmark = sighted.landmark_of_return[r];
    if (landmark != LineLandmarks::kNone) expected.insert({landmark, sighted.PoseOf(r)});
  }
  ASSERT_EQ(observations.num_landmarks(), static_cast<std::size_t>(kNumLandmarks));
  ASSERT_EQ(static_cast<int>(observations.num_poses()), sighted.graph.num_poses());
  ASSERT_EQ(observations.observations.size(), expected.size());
  ASSERT_EQ(observations.first_of_landmark.back(), expected.size());
  ASSERT_EQ(observations.first_of_pose.back(), expected.size());
  std::size_t index = 0;
  for (const auto& [landmark, pose] : expected) {
    const LineObservation& observation = observations.observations[index];
    EXPECT_EQ(observation.landmark, landmark);
    EXPECT_EQ(observation.pose, pose);
    EXPECT_EQ(observation.weight, 0.0);
    EXPECT_LE(observations.first_of_landmark[landmark], index);
    EXPECT_GT(observations.first_of_landmark[landmark + 1], index);
    ++index;
  }
  EXPECT_EQ(observations.first_of_landmark[4], observations.first_of_landmark[5]) << "never seen";
  std::vector<int> listed;
  for (std::size_t pose = 0; pose < observations.num_poses(); ++pose) {
    for (std::size_t k = observations.first_of_pose[pose]; k < observations.first_of_pose[pose + 1];
         ++k) {
      EXPECT_EQ(observations.observations[observations.of_pose[k]].pose, static_cast<int>(pose));
      if (k > observations.first_of_pose[pose]) {
        EXPECT_LT(observations.of_pose[k - 1], observations.of_pose[k]);
      }
      listed.push_back(observations.of_pose[k]);
    }
    if (pose % 5 == 4) {
      EXPECT_EQ(observations.first_of_pose[pose], observations.first_of_pose[pose + 1]);
    }
  }
  std::sort(listed.begin(), listed.end());
  for (std::size_t i = 0; i < listed.size(); ++i) EXPECT_EQ(listed[i], static_cast<int>(i));
}

TEST(LineObservationsTest, WeighsReturnsByLossAndVariance) {
  const Sighted sighted;
  const GemanMcClure loss = GemanMcClure::FromGate(3.0);
  ThreadPool pool(2);
  double cost = 0.0;
  const LineObservations observations = LayOutAndWeigh(sighted, loss, &pool, &cost);
  double expected_cost = 0.0;
  std::vector<double> weights(observations.observations.size(), 0.0);
  for (std::size_t r = 0; r < sighted.graph.num_returns(); ++r) {
    const int landmark = sighted.landmark_of_return[r];
    if (landmark == LineLandmarks::kNone) continue;
    const double distance = sighted.Distance(r, sighted.landmarks, sighted.graph.initial_poses());
    expected_cost += 0.5 * loss.Rho(distance * distance / sighted.Variance(r));
    std::size_t i = observations.first_of_landmark[landmark];
    while (observations.observations[i].pose != sighted.PoseOf(r)) ++i;
    weights[i] += sighted.Weight(r, loss);
  }
  EXPECT_NEAR(cost, expected_cost, 1e-6 * expected_cost);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_NEAR(observations.observations[i].weight, weights[i], 1e-5 * weights[i]);
  }
}

TEST(LineObservationsTest, EqualWeightsAreCounts) {
  const Sighted sighted;
  ThreadPool pool(2);
  ReturnCompressor compressor(sighted.graph, NoiseOf(sighted.factors), &pool);
  LineObservations observations = compressor.LayOut(kNumLandmarks, sighted.landmark_of_return);
  compressor.WeighEqually(&observations);
  std::vector<int> counts(observations.observations.size(), 0);
  std::vector<Eigen::Vector2d> sums(counts.size(), Eigen::Vector2d::Zero());
  for (std::size_t r = 0; r < sighted.graph.num_returns(); ++r) {
    if (sighted.landmark_of_return[r] == LineLandmarks::kNone) continue;
    std::size_t i = observations.first_of_landmark[sighted.landmark_of_return[r]];
    while (observations.observations[i].pose != sighted.PoseOf(r)) ++i;
    ++counts[i];
    sums[i] += sighted.graph.PointInRobot(r);
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    EXPECT_EQ(observations.observations[i].weight, counts[i]);
    EXPECT_LT((observations.observations[i].centroid() - sums[i] / counts[i]).norm(), 1e-5);
  }
}

TEST(LineObservationsTest, OnlySelectedReturnsCount) {
  const Sighted sighted;
  ThreadPool pool(2);
  ReturnCompressor compressor(sighted.graph, NoiseOf(sighted.factors), &pool);
  const auto count = [&](const ReturnSelection& selection) {
    LineObservations observations =
        compressor.LayOut(kNumLandmarks, sighted.landmark_of_return, {}, selection);
    compressor.WeighEqually(&observations);
    double sum = 0.0;
    for (const LineObservation& observation : observations.observations) sum += observation.weight;
    return sum;
  };
  const auto expected = [&](bool without_held_out, bool with_normal) {
    std::vector<char> counts(sighted.graph.num_returns());
    for (std::size_t r = 0; r < counts.size(); ++r) {
      counts[r] = sighted.landmark_of_return[r] != LineLandmarks::kNone &&
                  !(with_normal && sighted.surface.normals[r].IsNone());
    }
    if (without_held_out) counts = WithoutHeldOut(sighted.graph, counts, char{0});
    return std::count(counts.begin(), counts.end(), 1);
  };
  ReturnSelection selection;
  EXPECT_EQ(count(selection), expected(false, false));
  selection.without_held_out = true;
  EXPECT_EQ(count(selection), expected(true, false));
  selection.surface = &sighted.surface;
  EXPECT_EQ(count(selection), expected(true, true));
  EXPECT_LT(expected(true, true), expected(true, false));
  EXPECT_LT(expected(true, false), expected(false, false));
}

TEST(LineObservationsTest, CostsWhatItsReturnsCostAtAnyPoseAndLine) {
  const Sighted sighted;
  ThreadPool pool(2);
  RandomStates random(5);
  // Beams without noise of their own and without a gate: single precision of the measured points
  // leaves no trace in the weights.
  Sighted plain = sighted;
  plain.factors.beam.sigma_range_m = plain.factors.beam.sigma_bearing_rad = 1e-7;
  const GemanMcClure loss = GemanMcClure::FromGate(1e7);
  double cost = 0.0;
  const LineObservations observations = LayOutAndWeigh(plain, loss, &pool, &cost);
  for (int trial = 0; trial < 5; ++trial) {
    const std::vector<LineLandmark> lines = Sighted::RandomLines(&random);
    std::vector<double> poses = plain.graph.initial_poses();
    for (double& coordinate : poses) coordinate += random.Uniform(-1, 1);
    const std::vector<PoseFrame> frames = FramesOf(poses);
    double expected = 0.0, actual = 0.0;
    for (std::size_t r = 0; r < plain.graph.num_returns(); ++r) {
      if (plain.landmark_of_return[r] == LineLandmarks::kNone) continue;
      expected += 0.5 * plain.Weight(r, loss) * std::pow(plain.Distance(r, lines, poses), 2);
    }
    for (const LineObservation& s : observations.observations) {
      const LineLandmark& line = lines[s.landmark];
      const PoseFrame& frame = frames[s.pose];
      const Eigen::Vector2d point = frame.Rotate(s.centroid()) + frame.translation() - line.origin;
      const Eigen::Vector2d normal_in_robot = frame.RotateBack(line.normal);
      actual += 0.5 * (s.weight * std::pow(line.normal.dot(point) - line.offset_m, 2) +
                       normal_in_robot.dot(s.ScatterTimes(normal_in_robot)));
    }
    EXPECT_NEAR(actual, expected, 1e-7 * expected);
  }
}

TEST(LineObservationsTest, WeighingAgainStartsFromNothing) {
  const Sighted sighted;
  ThreadPool pool(1);
  ReturnCompressor compressor(sighted.graph, NoiseOf(sighted.factors), &pool);
  LineObservations observations = compressor.LayOut(kNumLandmarks, sighted.landmark_of_return);
  const std::vector<PoseFrame> frames = FramesOf(sighted.graph.initial_poses());
  const GemanMcClure loss = GemanMcClure::FromGate(2.0);
  compressor.Weigh(sighted.landmarks, frames, GemanMcClure::FromGate(50.0), &observations);
  compressor.WeighEqually(&observations);
  const double again = compressor.Weigh(sighted.landmarks, frames, loss, &observations);
  double cost = 0.0;
  const LineObservations once = LayOutAndWeigh(sighted, loss, &pool, &cost);
  EXPECT_EQ(again, cost);
  EXPECT_EQ(compressor.Cost(sighted.landmarks, frames, loss), cost);
  for (std::size_t i = 0; i < once.observations.size(); ++i) {
    ExpectSameBits(observations.observations[i], once.observations[i]);
  }
}

TEST(LineObservationsTest, AnotherLayoutTakesTheFirstOnesPlace) {
  const Sighted sighted;
  ThreadPool pool(1);
  ReturnCompressor compressor(sighted.graph, NoiseOf(sighted.factors), &pool);
  compressor.LayOut(kNumLandmarks, sighted.landmark_of_return);
  LineObservations all_on_one =
      compressor.LayOut(1, std::vector<int>(sighted.graph.num_returns(), 0));
  compressor.Weigh({LineLandmark()}, FramesOf(sighted.graph.initial_poses()),
                   GemanMcClure::FromGate(1e7), &all_on_one);
  EXPECT_EQ(all_on_one.observations.size(), 120u);
  const LineObservations none =
      compressor.LayOut(0, std::vector<int>(sighted.graph.num_returns(), LineLandmarks::kNone));
  EXPECT_TRUE(none.observations.empty());
  EXPECT_EQ(none.num_landmarks(), 0u);
  EXPECT_EQ(none.num_poses(), 150u);
}

TEST(LineObservationsTest, AnyNumberOfThreadsGivesTheSameBits) {
  for (const int num_poses : {1, 64, 65, 150}) {
    const Sighted sighted(num_poses);
    const GemanMcClure loss = GemanMcClure::FromGate(3.0);
    ThreadPool one(1);
    double expected_cost = 0.0, cost = 0.0;
    const LineObservations expected = LayOutAndWeigh(sighted, loss, &one, &expected_cost);
    for (const int num_threads : {2, 3, 8}) {
      ThreadPool pool(num_threads);
      const LineObservations observations = LayOutAndWeigh(sighted, loss, &pool, &cost);
      EXPECT_EQ(cost, expected_cost);
      EXPECT_EQ(observations.of_pose, expected.of_pose);
      ASSERT_EQ(observations.observations.size(), expected.observations.size());
      for (std::size_t i = 0; i < expected.observations.size(); ++i) {
        ExpectSameBits(observations.observations[i], expected.observations[i]);
      }
    }
  }
}

}  // namespace
}  // namespace plumbline
