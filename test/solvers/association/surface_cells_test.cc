#include "plumbline/solvers/association/surface_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

struct ScatteredReturns {
  SlamGraph graph;
  std::vector<double> poses;  ///< starts at the initial guesses
  MeasuredSurface surface;
};

/// Returns and normals in all directions, on both sides of the world's axes, from `num_scans` scans
/// of 40 poses in no order. Every seventh return has no normal, and every tenth scan no returns.
ScatteredReturns ScatterReturns(int num_scans) {
  ScatteredReturns scattered;
  RandomStates random(17);
  constexpr int kNumPoses = 40, kNumBeams = 12;
  const int laser = scattered.graph.AddLaser(PanoramicLaser(kNumBeams));
  for (int i = 0; i < kNumPoses; ++i) {
    scattered.graph.AddPose(random.Pose(), i);
  }
  for (int s = 0; s < num_scans; ++s) {
    const double longest_m = s % 10 == 9 ? kInfinity : 1.0;
    std::vector<double> ranges(kNumBeams, longest_m);
    for (double& range : ranges) range *= random.Uniform(0.1, 4.0);
    scattered.graph.AddScan((7 * s) % kNumPoses, laser, ranges);
  }
  scattered.poses = scattered.graph.initial_poses();
  for (std::size_t r = 0; r < scattered.graph.num_returns(); ++r) {
    const ReturnNormal normal(random.Direction());
    scattered.surface.normals.push_back(r % 7 == 3 ? ReturnNormal() : normal);
  }
  return scattered;
}

using Key = std::tuple<std::int64_t, std::int64_t, int>;
Key ToKey(const SurfaceCellKey& key) { return {key.x, key.y, key.octant}; }

/// Where a return and its normal lie in the frame of the grid.
struct Placed {
  Eigen::Vector2d point;
  double direction_rad;  // of the normal, against octant 0
  int pose;
  bool has_normal;
};

std::vector<Placed> PlaceReturns(const ScatteredReturns& scattered, const SurfaceGrid& grid) {
  std::vector<Placed> placed;
  for (std::size_t r = 0; r < scattered.graph.num_returns(); ++r) {
    const int pose = scattered.graph.scan(scattered.graph.ScanOfReturn(r)).pose;
    const Pose2 world_from_robot(&scattered.poses[3 * pose]);
    const Eigen::Vector2d in_robot = scattered.graph.PointInRobot(r);
    const ReturnNormal normal = scattered.surface.normals[r];
    const Eigen::Vector2d direction = normal.Direction();
    placed.push_back(
        {Pose2(0, 0, -grid.cell_yaw_rad) * Eigen::Vector2d(world_from_robot * in_robot),
         std::atan2(direction.y(), direction.x()) + world_from_robot.yaw - grid.octant_yaw_rad,
         pose, !normal.IsNone()});
  }
  return placed;
}

/// The cell that a return belongs to, by way of an angle instead of comparisons.
Key KeyOf(const Placed& placed, double cell_m) {
  const int octant = static_cast<int>(std::lround(placed.direction_rad / (kPi / 4.0))) & 7;
  return {std::llround(std::floor(placed.point.x() / cell_m)),
          std::llround(std::floor(placed.point.y() / cell_m)), octant};
}

void ExpectNear(const PointMoments& a, const PointMoments& b, double tolerance) {
  EXPECT_NEAR(a.weight, b.weight, tolerance);
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.xx, b.xx, tolerance);
  EXPECT_NEAR(a.xy, b.xy, tolerance);
  EXPECT_NEAR(a.yy, b.yy, tolerance);
}

/// Every cell of the table is what a map of all returns gives, and there are no others.
void ExpectCellsOf(const std::vector<Placed>& placed, SurfaceCells cells) {
  std::map<Key, std::set<int>> poses;
  std::map<Key, PointMoments> moments;
  for (const Placed& p : placed) {
    if (!p.has_normal) continue;
    const Key key = KeyOf(p, cells.cell_m());
    poses[key].insert(p.pose);
    moments[key].Add(p.point.x() - (std::get<0>(key) + 0.5) * cells.cell_m(),
                     p.point.y() - (std::get<1>(key) + 0.5) * cells.cell_m());
  }
  ASSERT_EQ(cells.size(), moments.size());
  std::set<Key> seen;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const Key key = ToKey(cells[i].key);
    ASSERT_EQ(moments.count(key), 1u);
    EXPECT_TRUE(seen.insert(key).second) << "twice";
    ExpectNear(cells[i].moments, moments[key], 1e-10);
    EXPECT_EQ(cells[i].several_poses, poses[key].size() > 1);
    EXPECT_EQ(poses[key].count(cells[i].pose), 1u);
    EXPECT_EQ(cells.FindOrInsert(cells[i].key), static_cast<int>(i));
  }
}

constexpr SurfaceGrid kTurnedGrid{0.3, 0.4, -0.2};

TEST(SurfaceCellsTest, AgreesWithAPlainMap) {
  // More scans than are sorted at once.
  const ScatteredReturns scattered = ScatterReturns(8500);
  ThreadPool pool(2);
  std::vector<int> cell_of_return;
  const SurfaceCells cells = SortIntoCells(scattered.graph, scattered.poses, scattered.surface,
                                           kTurnedGrid, &pool, &cell_of_return);
  const std::vector<Placed> placed = PlaceReturns(scattered, kTurnedGrid);
  ExpectCellsOf(placed, cells);
  ASSERT_EQ(cell_of_return.size(), placed.size());
  int several = 0, negative = 0;
  for (std::size_t r = 0; r < placed.size(); ++r) {
    if (!placed[r].has_normal) {
      EXPECT_EQ(cell_of_return[r], SurfaceCells::kNone);
      continue;
    }
    ASSERT_NE(cell_of_return[r], SurfaceCells::kNone);
    const SurfaceCell& cell = cells[cell_of_return[r]];
    EXPECT_EQ(ToKey(cell.key), KeyOf(placed[r], kTurnedGrid.cell_m));
    several += cell.several_poses;
    negative += cell.key.x < 0 && cell.key.y < 0;
  }
  EXPECT_GT(several, 500);
  EXPECT_GT(negative, 500);
}

TEST(SurfaceCellsTest, CountsPosesAndNotScans) {
  ScatteredReturns scattered = ScatterReturns(0);
  scattered.poses =
      PoseArray(std::vector<Pose2>(scattered.graph.num_poses(), Pose2(0.05, 0.05, 0.0)));
  for (const int pose : {3, 3, 5, 3}) {
    std::vector<double> ranges(12, kInfinity);
    ranges[4] = 1.0;
    scattered.graph.AddScan(pose, 0, ranges);
    scattered.surface.normals.emplace_back(Eigen::Vector2d(1.0, 0.0));
    ThreadPool pool(1);
    std::vector<int> cell_of_return;
    const SurfaceCells cells = SortIntoCells(scattered.graph, scattered.poses, scattered.surface,
                                             {1.0, 0.0, 0.0}, &pool, &cell_of_return);
    ASSERT_EQ(cells.size(), 1u);
    EXPECT_EQ(cells[0].several_poses, scattered.graph.num_scans() > 2);
  }
}

TEST(SurfaceCellsTest, AnyNumberOfThreadsGivesTheSameBits) {
  for (const int num_scans : {1, 255, 256, 257, 1100}) {
    const ScatteredReturns scattered = ScatterReturns(num_scans);
    std::vector<int> cell_of_return, expected_cell_of_return;
    ThreadPool one(1);
    const SurfaceCells expected = SortIntoCells(scattered.graph, scattered.poses, scattered.surface,
                                                kTurnedGrid, &one, &expected_cell_of_return);
    for (const int num_threads : {2, 3, 8}) {
      ThreadPool pool(num_threads);
      const SurfaceCells cells = SortIntoCells(scattered.graph, scattered.poses, scattered.surface,
                                               kTurnedGrid, &pool, &cell_of_return);
      EXPECT_EQ(cell_of_return, expected_cell_of_return);
      ASSERT_EQ(cells.size(), expected.size());
      for (std::size_t i = 0; i < cells.size(); ++i) {
        EXPECT_EQ(ToKey(cells[i].key), ToKey(expected[i].key));
        EXPECT_EQ(cells[i].pose, expected[i].pose);
        // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): to the last bit
        EXPECT_EQ(0, std::memcmp(&cells[i].moments, &expected[i].moments, sizeof(PointMoments)));
      }
      EXPECT_EQ(DominantDirection(scattered.graph, scattered.poses, scattered.surface, &pool),
                DominantDirection(scattered.graph, scattered.poses, scattered.surface, &one));
    }
  }
}

TEST(SurfaceCellsTest, CoarseCellsAreWhatSortingIntoThemGives) {
  const ScatteredReturns scattered = ScatterReturns(300);
  ThreadPool pool(1);
  std::vector<int> cell_of_return;
  std::vector<SurfaceCells> tables = {SortIntoCells(
      scattered.graph, scattered.poses, scattered.surface, kTurnedGrid, &pool, &cell_of_return)};
  for (int level = 0; level < 3; ++level) {
    for (std::size_t i = 0; i < tables.back().size(); ++i) {
      EXPECT_EQ(tables.back()[i].parent, SurfaceCells::kNone);
    }
    tables.push_back(Coarsened(&tables.back()));
    const SurfaceCells &fine = tables[level], &coarse = tables[level + 1];
    EXPECT_EQ(coarse.cell_m(), 2.0 * fine.cell_m());
    ExpectCellsOf(PlaceReturns(scattered, kTurnedGrid), coarse);
    for (std::size_t i = 0; i < fine.size(); ++i) {
      const SurfaceCellKey& parent = coarse[fine[i].parent].key;
      EXPECT_EQ(parent.x, std::floor(fine[i].key.x / 2.0));
      EXPECT_EQ(parent.y, std::floor(fine[i].key.y / 2.0));
      EXPECT_EQ(parent.octant, fine[i].key.octant);
    }
  }
}

TEST(SurfaceCellsTest, KeepsItsDigitsFarFromTheOrigin) {
  ScatteredReturns scattered = ScatterReturns(100);
  ThreadPool pool(1);
  std::vector<int> near, far;
  const SurfaceGrid grid{0.25, 0.0, 0.0};
  const SurfaceCells expected =
      SortIntoCells(scattered.graph, scattered.poses, scattered.surface, grid, &pool, &near);
  constexpr std::int64_t kShiftCells = 1 << 22;  // 1000 km; exact in binary
  for (std::size_t i = 0; i < scattered.poses.size(); i += 3) {
    scattered.poses[i] -= 0.25 * kShiftCells;
    scattered.poses[i + 1] += 0.25 * kShiftCells;
  }
  const SurfaceCells cells =
      SortIntoCells(scattered.graph, scattered.poses, scattered.surface, grid, &pool, &far);
  ASSERT_EQ(far, near);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    EXPECT_EQ(cells[i].key.x, expected[i].key.x - kShiftCells);
    EXPECT_EQ(cells[i].key.y, expected[i].key.y + kShiftCells);
    ExpectNear(cells[i].moments, expected[i].moments, 1e-7);
  }
}

TEST(SurfaceCellsTest, TheTableGrowsAndFindsAll) {
  SurfaceCells cells(1.0);
  std::vector<SurfaceCellKey> keys;
  for (int x = -40; x < 40; ++x) {
    for (int y = -40; y < 40; ++y) keys.push_back({x, y, (x + 2 * y) & 7});
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    EXPECT_EQ(cells.FindOrInsert(keys[i]), static_cast<int>(i));
  }
  for (std::size_t i = 0; i < keys.size(); ++i) {
    EXPECT_EQ(cells.FindOrInsert(keys[i]), static_cast<int>(i));
  }
  EXPECT_EQ(cells.size(), keys.size());
  // Another octant of a square is another cell.
  for (std::size_t i = 0; i < keys.size(); ++i) {
    keys[i].octant ^= 1;
    EXPECT_EQ(cells.FindOrInsert(keys[i]), static_cast<int>(keys.size() + i));
  }
}

TEST(SurfaceCellsTest, TheDominantDirectionIsThatOfTheWalls) {
  for (const double walls_rad : {-0.7, -0.3, 0.0, 0.2, 0.7}) {
    ScatteredReturns scattered = ScatterReturns(600);
    RandomStates random(8);
    for (std::size_t r = 0; r < scattered.graph.num_returns(); ++r) {
      ReturnNormal& normal = scattered.surface.normals[r];
      if (normal.IsNone() || r % 3 == 0) continue;  // a third stays clutter
      const int pose = scattered.graph.scan(scattered.graph.ScanOfReturn(r)).pose;
      const double angle = walls_rad + 0.5 * kPi * static_cast<double>(r % 4) +
                           random.Gaussian(0.02) - scattered.graph.InitialPose(pose).yaw;
      normal = ReturnNormal({std::cos(angle), std::sin(angle)});
    }
    ThreadPool pool(2);
    EXPECT_NEAR(DominantDirection(scattered.graph, scattered.poses, scattered.surface, &pool),
                walls_rad, 0.02);
  }
  ScatteredReturns nothing = ScatterReturns(10);
  for (ReturnNormal& normal : nothing.surface.normals) normal = {};
  ThreadPool pool(1);
  EXPECT_EQ(DominantDirection(nothing.graph, nothing.poses, nothing.surface, &pool), 0.0);
}

}  // namespace
}  // namespace plumbline
