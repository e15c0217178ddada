#include "plumbline/solvers/landmarks/line_landmarks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "plumbline/factors/surface_noise.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

/// A scene cut into landmarks.
struct CutScene {
  SlamGraph graph;
  std::vector<double> poses;
  MeasuredSurface surface;
  LineLandmarks cut;
  SurfaceNoise noise;
  LineLandmarkOptions options;  ///< with that noise

  explicit CutScene(const SyntheticScene& scene) : CutScene(scene, scene.poses) {}
  /// Seen from `scene.poses`, and cut as if from `believed_poses`.
  CutScene(const SyntheticScene& scene, const std::vector<Pose2>& believed_poses)
      : graph(MakeGraph(scene)), poses(PoseArray(believed_poses)) {
    ThreadPool pool(2);
    ReturnNormalOptions measuring;
    measuring.half_window_m = std::max(0.06, 6.0 * scene.range_sigma_m);
    surface = MeasureSurface(graph, measuring, &pool);
    FactorOptions factors;
    if (scene.range_sigma_m > 0.0) factors.beam.sigma_range_m = scene.range_sigma_m;
    noise = NoiseOf(factors);
    Cut();
  }

  void Cut(int num_threads = 2) {
    ThreadPool pool(num_threads);
    options.noise = noise;
    cut = CutIntoLandmarks(graph, poses, surface, options, &pool);
  }

  std::size_t num_landmarks() const { return cut.landmarks.size(); }
  int PoseOf(std::size_t r) const { return graph.scan(graph.ScanOfReturn(r)).pose; }
  Pose2 WorldFromRobot(int pose) const { return Pose2(&poses[3 * pose]); }
  bool HasLandmark(std::size_t r) const {
    return cut.landmark_of_return[r] != LineLandmarks::kNone;
  }

  Eigen::Vector2d End(std::size_t r) const {
    return WorldFromRobot(PoseOf(r)) * graph.PointInRobot(r);
  }
  double Distance(std::size_t r) const {
    const LineLandmark& landmark = cut.landmarks[cut.landmark_of_return[r]];
    return landmark.normal.dot(End(r) - landmark.origin) - landmark.offset_m;
  }
  /// Standard deviation of its distance [m].
  double NoiseOfReturn(std::size_t r) const {
    const LineLandmark& landmark = cut.landmarks[cut.landmark_of_return[r]];
    const Pose2 world_from_laser = graph.WorldFromLaser(graph.ScanOfReturn(r), poses);
    const Eigen::Vector2d beam = End(r) - world_from_laser.translation();
    return std::sqrt(noise.surface_variance +
                     noise.BeamVariance(beam.norm(), beam.normalized(), landmark.normal));
  }
  double RmsDistance() const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t r = 0; r < graph.num_returns(); ++r) {
      if (!HasLandmark(r)) continue;
      sum += std::pow(Distance(r), 2);
      ++count;
    }
    return std::sqrt(sum / count);
  }
  /// Share of the returns with a normal.
  double CoveredShare() const {
    int with_normal = 0, with_landmark = 0;
    for (std::size_t r = 0; r < graph.num_returns(); ++r) {
      with_normal += !surface.normals[r].IsNone();
      with_landmark += HasLandmark(r);
    }
    return static_cast<double>(with_landmark) / with_normal;
  }

  /// What holds for every cut: unit normals, landmarks of enough returns, returns near their
  /// landmark, those without a normal near its line.
  void ExpectSound() const {
    std::vector<int> counts(num_landmarks(), 0);
    ASSERT_EQ(cut.landmark_of_return.size(), graph.num_returns());
    for (std::size_t r = 0; r < graph.num_returns(); ++r) {
      if (!HasLandmark(r)) continue;
      const int landmark = cut.landmark_of_return[r];
      ASSERT_GE(landmark, 0);
      ASSERT_LT(landmark, static_cast<int>(num_landmarks()));
      EXPECT_LE((End(r) - cut.landmarks[landmark].origin).norm(), 0.8 * std::sqrt(0.5) + 1e-6);
      if (surface.normals[r].IsNone()) {
        EXPECT_LE(std::abs(Distance(r)), 3.0 * NoiseOfReturn(r));
        continue;
      }
      ++counts[landmark];
    }
    for (std::size_t p = 0; p < num_landmarks(); ++p) {
      EXPECT_NEAR(cut.landmarks[p].normal.norm(), 1.0, 1e-12);
      EXPECT_GE(counts[p], 5);
    }
  }
};

/// Poses on a line, each looking around.
std::vector<Pose2> PosesAlong(double from_x, double to_x, int count, double y = 0.0) {
  std::vector<Pose2> poses;
  for (int i = 0; i < count; ++i) {
    poses.emplace_back(from_x + (to_x - from_x) * i / std::max(1, count - 1), y, 0.3 * i);
  }
  return poses;
}

/// The scene turned about the world's origin.
SyntheticScene Turned(SyntheticScene scene, double angle) {
  const Pose2 turn(0.0, 0.0, angle);
  for (Face& face : scene.faces) face = {turn * face.a, turn * face.b};
  for (Disc& disc : scene.discs) disc.center = turn * disc.center;
  for (Pose2& pose : scene.poses) pose = turn * pose;
  return scene;
}

constexpr double kAngles[] = {0.0, 0.35, 0.7853981633974483, 1.5707963267948966, 2.0};

TEST(LineLandmarksTest, AStraightWallBecomesFewLandmarksOnIt) {
  for (const double range_sigma_m : {0.0, 0.01, 0.03}) {
    for (const double angle : kAngles) {
      SyntheticScene scene;
      scene.faces = {{{-8, 1.5}, {8, 1.5}}};
      scene.poses = PosesAlong(-8, 8, 33);
      scene.range_sigma_m = range_sigma_m;
      const CutScene wall(Turned(scene, angle));
      wall.ExpectSound();
      EXPECT_GT(wall.CoveredShare(), 0.97);
      // A straight line of length l meets about l (|cos| + |sin|) / 0.8 cells of 0.8 m.
      EXPECT_LE(wall.num_landmarks(), 40u) << range_sigma_m << " " << angle;
      EXPECT_LE(wall.RmsDistance(), 1.1 * range_sigma_m + 1e-5);
      const Eigen::Vector2d across = Pose2(0, 0, angle) * Eigen::Vector2d(0, 1);
      // Few returns at the wall's very ends may make a line by chance.
      std::size_t astray = 0;
      for (std::size_t r = 0; r < wall.graph.num_returns(); ++r) {
        if (!wall.HasLandmark(r)) continue;
        const LineLandmark& landmark = wall.cut.landmarks[wall.cut.landmark_of_return[r]];
        astray += std::abs(landmark.normal.dot(across)) < std::cos(0.1);
      }
      EXPECT_LT(astray, wall.graph.num_returns() / 20);
    }
  }
}

TEST(LineLandmarksTest, TheSidesOfACornerStayApart) {
  for (const double angle : kAngles) {
    SyntheticScene scene;
    scene.faces = {{{-3, 1}, {1, 1}}, {{1, 1}, {1, -3}}};
    scene.poses = PosesAlong(-1.5, 0, 8, -0.2);
    scene.range_sigma_m = 0.005;
    const CutScene corner(Turned(scene, angle));
    corner.ExpectSound();
    EXPECT_GT(corner.CoveredShare(), 0.9);
    EXPECT_LT(corner.RmsDistance(), 0.01);
    // A landmark holds returns of one side only, but for the last centimetres.
    int astray = 0, count = 0;
    for (std::size_t r = 0; r < corner.graph.num_returns(); ++r) {
      if (!corner.HasLandmark(r)) continue;
      ++count;
      astray += std::abs(corner.Distance(r)) > 0.03;
    }
    EXPECT_LT(astray, count / 100);
  }
}

TEST(LineLandmarksTest, TheFacesOfAThinWallStayApart) {
  for (const double angle : kAngles) {
    SyntheticScene scene;
    scene.faces = {{{-4, 0}, {4, 0}}, {{-4, 0.05}, {4, 0.05}}};
    scene.poses = PosesAlong(-3, 3, 10, -1.0);
    for (const Pose2& pose : PosesAlong(-3, 3, 10, 1.0)) scene.poses.push_back(pose);
    scene.range_sigma_m = 0.005;
    const CutScene wall(Turned(scene, angle));
    wall.ExpectSound();
    EXPECT_GT(wall.CoveredShare(), 0.95);
    std::vector<std::set<bool>> faces(wall.num_landmarks());
    for (std::size_t r = 0; r < wall.graph.num_returns(); ++r) {
      if (wall.HasLandmark(r)) faces[wall.cut.landmark_of_return[r]].insert(wall.PoseOf(r) < 10);
    }
    for (const std::set<bool>& of_landmark : faces) EXPECT_EQ(of_landmark.size(), 1u);
    EXPECT_LT(wall.RmsDistance(), 0.0075);
  }
}

TEST(LineLandmarksTest, BothImagesOfADoubleWallShareALine) {
  // Half of the poses are wrong by 6 cm: one line per landmark lets both sides pull.
  for (const double angle : kAngles) {
    for (const double wall_y : {1.0, 1.3, 1.55}) {
      SyntheticScene scene;
      scene.faces = {{{-8, wall_y}, {8, wall_y}}};
      scene.poses = PosesAlong(-8, 8, 40);
      scene.range_sigma_m = 0.01;
      scene = Turned(scene, angle);
      const Eigen::Vector2d shift = Pose2(0, 0, angle) * Eigen::Vector2d(0, 0.06);
      std::vector<Pose2> poses = scene.poses;
      for (std::size_t i = 0; i < poses.size(); i += 2) {
        poses[i].x += shift.x();
        poses[i].y += shift.y();
      }
      const CutScene wall(scene, poses);
      wall.ExpectSound();
      EXPECT_GT(wall.CoveredShare(), 0.95) << angle << " " << wall_y;
      std::vector<int> shifted(wall.num_landmarks()), unshifted(wall.num_landmarks());
      for (std::size_t r = 0; r < wall.graph.num_returns(); ++r) {
        if (!wall.HasLandmark(r)) continue;
        ++(wall.PoseOf(r) % 2 == 0 ? shifted : unshifted)[wall.cut.landmark_of_return[r]];
      }
      int shared = 0, alone = 0;
      for (std::size_t p = 0; p < shifted.size(); ++p) {
        const int total = shifted[p] + unshifted[p];
        (5 * std::min(shifted[p], unshifted[p]) > total ? shared : alone) += total;
      }
      EXPECT_GT(shared, 9 * alone) << angle << " " << wall_y;
      EXPECT_NEAR(wall.RmsDistance(), 0.03, 0.01);
    }
  }
}

TEST(LineLandmarksTest, LandmarksResolveACurveThatReturnsTell) {
  // A round pillar of 1 m, seen from all around.
  const auto pillar = [](int num_poses, int num_beams, double range_sigma_m) {
    SyntheticScene scene;
    scene.discs = {{{0.1, 0.2}, 1.0}};
    scene.laser = PanoramicLaser(num_beams);
    scene.range_sigma_m = range_sigma_m;
    for (int i = 0; i < num_poses; ++i) {
      const double turn = 2.0 * kPi * i / num_poses;
      scene.poses.emplace_back(2.5 * std::cos(turn), 2.5 * std::sin(turn), 0.1 * i);
    }
    return CutScene(scene);
  };
  const CutScene dense = pillar(60, 1440, 0.002);
  dense.ExpectSound();
  EXPECT_GT(dense.CoveredShare(), 0.95);
  EXPECT_LT(dense.RmsDistance(), 0.004);
  const CutScene sparse = pillar(12, 360, 0.02);
  sparse.ExpectSound();
  EXPECT_GT(sparse.num_landmarks(), 0u);
  EXPECT_LT(sparse.RmsDistance(), 0.04);
  EXPECT_GT(dense.num_landmarks(), 1.5 * sparse.num_landmarks());
}

TEST(LineLandmarksTest, OnePoseIsEnough) {
  SyntheticScene scene;
  scene.faces = {{{-3, 1}, {3, 1}}};
  scene.poses = {{0, 0, 0.1}};
  CutScene wall(scene);
  EXPECT_GT(wall.num_landmarks(), 3u);
  EXPECT_GT(wall.CoveredShare(), 0.9);
  wall.ExpectSound();
}

TEST(LineLandmarksTest, OptionsSetTheSize) {
  SyntheticScene scene;
  scene.faces = {{{-3, 1}, {3, 1}}};
  scene.poses = {{0, 0, 0.1}};
  scene.range_sigma_m = 0.01;
  const SlamGraph graph = MakeGraph(scene);
  AssociationOptions association;
  std::size_t num_landmarks[2];
  ThreadPool pool(1);
  for (int i = 0; i < 2; ++i) {
    association.landmark_size_m = i == 0 ? 0.4 : 1.6;
    const LineLandmarkOptions options = LandmarkOptionsFor(FactorOptions(), association);
    num_landmarks[i] =
        CutIntoLandmarks(graph, graph.initial_poses(), SurfaceOf(graph), options, &pool)
            .landmarks.size();
  }
  EXPECT_GT(num_landmarks[1], 2u);
  EXPECT_GT(num_landmarks[0], 1.5 * static_cast<double>(num_landmarks[1]));
}

TEST(LineLandmarksTest, SizesGrowWithTheNoise) {
  // At 0.1 m, a stretch of 0.8 m looks round.
  SyntheticScene scene;
  scene.faces = {{{-6, 2}, {6, 2}}};
  scene.poses = PosesAlong(-2, 2, 6);
  scene.range_sigma_m = 0.1;
  const CutScene fixed(scene);
  FactorOptions factors;
  factors.beam.sigma_range_m = scene.range_sigma_m;
  const LineLandmarkOptions options = LandmarkOptionsFor(factors, AssociationOptions());
  EXPECT_GT(options.largest_m, 3.0);
  EXPECT_EQ(LandmarkOptionsFor(FactorOptions(), AssociationOptions()).largest_m, 0.8);
  ThreadPool pool(1);
  CutScene following = fixed;
  following.cut = CutIntoLandmarks(fixed.graph, fixed.poses, fixed.surface, options, &pool);
  EXPECT_LT(fixed.CoveredShare(), 0.7);
  EXPECT_GT(following.CoveredShare(), 0.9);
  EXPECT_LT(following.RmsDistance(), 1.2 * scene.range_sigma_m);
}

TEST(LineLandmarksTest, NormalsMakeTheLandmarks) {
  SyntheticScene scene;
  scene.faces = {{{-3, 1}, {3, 1}}};
  scene.poses = PosesAlong(-1, 1, 6);
  CutScene wall(scene);
  for (std::size_t r = 0; r < wall.surface.normals.size(); ++r) {
    if (r % 3 == 0) wall.surface.normals[r] = {};
  }
  wall.Cut();
  EXPECT_GT(wall.num_landmarks(), 3u);
  wall.ExpectSound();
  for (ReturnNormal& normal : wall.surface.normals) normal = {};
  wall.Cut();
  EXPECT_EQ(wall.num_landmarks(), 0u);
}

// A wall that two poses look at, and the same returns with some of the normals taken away.
class ReturnsWithoutNormalTest : public testing::Test {
 protected:
  ReturnsWithoutNormalTest() : scene_(Wall()) {}

  static SyntheticScene Wall() {
    SyntheticScene scene;
    scene.faces = {{{-2.0, 1.0}, {2.0, 1.0}}};
    scene.poses = PosesAlong(-0.5, 0.5, 4);
    scene.range_sigma_m = 0.01;
    return scene;
  }
  // Every tenth of those with a landmark.
  std::vector<std::size_t> TakeNormals() {
    std::vector<std::size_t> taken;
    for (std::size_t r = 0; r < scene_.graph.num_returns(); r += 10) {
      if (!scene_.HasLandmark(r)) continue;
      scene_.surface.normals[r] = {};
      taken.push_back(r);
    }
    return taken;
  }

  void ScaleRanges(const std::vector<std::size_t>& returns, double factor) {
    const std::vector<float>& ranges_m = scene_.graph.returns().range_m;
    MeasurementCorrections corrections;
    corrections.range_m.assign(ranges_m.begin(), ranges_m.end());
    for (const std::size_t r : returns) corrections.range_m[r] *= factor;
    scene_.graph = scene_.graph.Corrected(corrections);
  }

  CutScene scene_;
};

TEST_F(ReturnsWithoutNormalTest, JoinTheLineNextToThem) {
  const std::vector<std::size_t> taken = TakeNormals();
  ASSERT_GT(taken.size(), 20u);
  scene_.Cut();
  int joined = 0;
  for (const std::size_t r : taken) {
    if (!scene_.HasLandmark(r)) continue;
    EXPECT_LE(std::abs(scene_.Distance(r)), 3.0 * scene_.NoiseOfReturn(r));
    ++joined;
  }
  EXPECT_GT(joined, 0.95 * taken.size());
}

TEST_F(ReturnsWithoutNormalTest, HaveNoSayInHowTheSurfacesAreCut) {
  const std::vector<std::size_t> taken = TakeNormals();
  scene_.Cut();
  const LineLandmarks before = scene_.cut;
  ScaleRanges(taken, 1.5);
  scene_.Cut();
  ASSERT_EQ(scene_.num_landmarks(), before.landmarks.size());
  for (std::size_t p = 0; p < before.landmarks.size(); ++p) {
    EXPECT_EQ(scene_.cut.landmarks[p].offset_m, before.landmarks[p].offset_m);
  }
}

TEST_F(ReturnsWithoutNormalTest, StayAloneIfTheyAreNotAskedFor) {
  const std::vector<std::size_t> taken = TakeNormals();
  scene_.Cut();
  const LineLandmarks joined = scene_.cut;
  scene_.options.joins_without_normal = false;
  scene_.Cut();
  EXPECT_EQ(scene_.num_landmarks(), joined.landmarks.size());
  for (std::size_t r = 0; r < scene_.graph.num_returns(); ++r) {
    const bool has_normal = !scene_.surface.normals[r].IsNone();
    EXPECT_EQ(scene_.cut.landmark_of_return[r],
              has_normal ? joined.landmark_of_return[r] : LineLandmarks::kNone);
  }
}

TEST_F(ReturnsWithoutNormalTest, StayAloneIfTheyMove) {
  MeasurementCorrections corrections;
  corrections.moving_returns = TakeNormals();
  scene_.graph = scene_.graph.Corrected(corrections);
  scene_.Cut();
  for (const std::size_t r : corrections.moving_returns) EXPECT_FALSE(scene_.HasLandmark(r));
}

TEST_F(ReturnsWithoutNormalTest, StayAloneMoreThanThreeSigmasOff) {
  const std::vector<std::size_t> taken = TakeNormals();
  ScaleRanges(taken, 1.0 - 8.0 * scene_.noise.StandardDeviation());  // 1 m away or more
  scene_.Cut();
  for (const std::size_t r : taken) EXPECT_FALSE(scene_.HasLandmark(r));
}

TEST_F(ReturnsWithoutNormalTest, StayAloneOnTheFarSide) {
  const std::vector<std::size_t> taken = TakeNormals();
  // The same points seen by a robot beyond the wall.
  SlamGraph& graph = scene_.graph;
  const int beyond = graph.AddPose({0.0, 2.0, 0.0}, 99.0);
  scene_.poses = graph.initial_poses();
  std::vector<Eigen::Vector2d> points;
  for (const std::size_t r : taken) {
    points.push_back(graph.InitialPose(beyond).Inverse() * scene_.End(r));
  }
  const std::size_t first = graph.num_returns();
  graph.AddPoints(beyond, 0, points);
  for (std::size_t r = first; r < graph.num_returns(); ++r) {
    scene_.surface.normals.emplace_back();
  }
  ASSERT_EQ(graph.num_returns(), first + taken.size());
  scene_.Cut();
  for (std::size_t r = first; r < graph.num_returns(); ++r) EXPECT_FALSE(scene_.HasLandmark(r));
}

TEST(LineLandmarksTest, FarFromTheOriginItIsTheSame) {
  SyntheticScene scene;
  scene.faces = {{{-8, 1.5}, {8, 1.5}}};
  scene.poses = PosesAlong(-8, 8, 33);
  scene.range_sigma_m = 0.01;
  CutScene wall(scene);
  const double rms_m = wall.RmsDistance();
  for (std::size_t i = 0; i < wall.poses.size(); i += 3) {
    wall.poses[i] += 1e6;
    wall.poses[i + 1] -= 1e6;
  }
  wall.Cut();
  wall.ExpectSound();
  EXPECT_LE(wall.num_landmarks(), 40u);
  EXPECT_NEAR(wall.RmsDistance(), rms_m, 0.1 * rms_m);
}

TEST(LineLandmarksTest, AnyNumberOfThreadsGivesTheSameBits) {
  SyntheticScene scene;
  scene.faces = {{{-8, 1.5}, {8, 1.5}}, {{-8, -1.2}, {8, -1.2}}};
  scene.poses = PosesAlong(-8, 8, 300);
  scene.laser = PanoramicLaser(240);
  scene.range_sigma_m = 0.01;
  CutScene hall(scene);
  hall.Cut(1);
  const LineLandmarks expected = hall.cut;
  for (const int num_threads : {2, 3, 8}) {
    hall.Cut(num_threads);
    EXPECT_EQ(hall.cut.landmark_of_return, expected.landmark_of_return);
    ASSERT_EQ(hall.num_landmarks(), expected.landmarks.size());
    for (std::size_t p = 0; p < hall.num_landmarks(); ++p) {
      EXPECT_EQ(hall.cut.landmarks[p].origin, expected.landmarks[p].origin);
      EXPECT_EQ(hall.cut.landmarks[p].normal, expected.landmarks[p].normal);
      EXPECT_EQ(hall.cut.landmarks[p].offset_m, expected.landmarks[p].offset_m);
    }
  }
}

}  // namespace
}  // namespace plumbline
