#include "plumbline/apps/io/occupancy_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/io/ros_map.h"
#include "plumbline/core/angle.h"
#include "plumbline/test/apps/io/ros_map_reader.h"
#include "plumbline/test/core/synthetic_scene.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

// A room of 7.93 m x 5.17 m whose lower left corner is at (-10.02, 3.01), with a wall of two faces,
// 6 cm apart, from its lower side up to y = 6.51.
SyntheticScene Room() {
  SyntheticScene scene;
  const Eigen::Vector2d low(-10.02, 3.01), high(-2.09, 8.18);
  const Eigen::Vector2d right(high.x(), low.y()), left(low.x(), high.y());
  scene.faces = {{low, right}, {right, high}, {high, left}, {left, low}};
  for (const double x : {-6.04, -5.98}) scene.faces.push_back({{x, 3.01}, {x, 6.51}});
  scene.faces.push_back({{-6.04, 6.51}, {-5.98, 6.51}});
  for (int i = 0; i < 12; ++i) {
    // Over the end of the wall from one side to the other.
    scene.poses.emplace_back(-9.3 + 0.57 * i, 5.0 + 2.3 * std::sin(0.24 * i), 0.4 * i);
  }
  scene.range_sigma_m = 0.01;
  return scene;
}

class OccupancyGridTest : public testing::Test {
 protected:
  OccupancyGrid Build(const SlamGraph& graph, const MapState& state) const {
    OccupancyGrid grid;
    const Status status = BuildOccupancyGrid(graph, state, options_, &grid);
    EXPECT_TRUE(status.ok()) << status.message();
    return grid;
  }
  OccupancyGrid Build(const SlamGraph& graph) const { return Build(graph, graph.InitialState()); }
  // As a robot gets it.
  ServedMap Serve(const SlamGraph& graph, const MapState& state) const {
    const std::string stem = TempFolder() + "map";
    EXPECT_TRUE(WriteRosMap(stem, Build(graph, state)).ok());
    return ServeMap(stem + ".yaml");
  }
  ServedMap Serve(const SlamGraph& graph) const { return Serve(graph, graph.InitialState()); }
  std::string ErrorOf(const SlamGraph& graph, const MapState& state) const {
    OccupancyGrid grid;
    grid.width = 77;
    const Status status = BuildOccupancyGrid(graph, state, options_, &grid);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_EQ(grid.width, 77);
    return status.message();
  }

  OccupancyGridOptions options_;
};

// Distance [m] from a point to the first cell in a direction that is not free; how it is there.
std::pair<double, Occupancy> Walk(const ServedMap& map, const Eigen::Vector2d& from,
                                  double bearing_rad) {
  for (double distance = 0.0;; distance += 0.002) {
    const Eigen::Vector2d at = from + BeamEnd(distance, bearing_rad);
    const Occupancy occupancy = map.At(at.x(), at.y());
    if (occupancy != Occupancy::kFree) return {distance, occupancy};
  }
}

TEST_F(OccupancyGridTest, ARayEndsAtTheWallWhereTheTruthSays) {
  const SyntheticScene scene = Room();
  const ServedMap map = Serve(MakeGraph(scene));
  Building building;
  building.faces = scene.faces;
  const World world(std::move(building));
  for (const Pose2& pose : scene.poses) {
    for (int i = 0; i < 90; ++i) {
      const double bearing = 2.0 * kPi * i / 90.0;
      const auto [distance, occupancy] = Walk(map, pose.translation(), bearing);
      // Where the ray passes close to the end of a wall, the cells of that end count.
      const Eigen::Vector2d aside = BeamEnd(0.1, bearing + 0.5 * kPi);
      double nearest = 100.0, farthest = 0.0;
      for (const double side : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        const double truth = world.CastRay(pose.translation() + side * aside, bearing);
        nearest = std::min(nearest, truth);
        farthest = std::max(farthest, truth);
      }
      EXPECT_GT(distance, nearest - 0.15) << pose.x << ' ' << pose.y << ' ' << bearing;
      EXPECT_LT(distance, farthest + 0.12) << pose.x << ' ' << pose.y << ' ' << bearing;
    }
    // Straight up to the upper side.
    const auto [distance, occupancy] = Walk(map, pose.translation(), 0.5 * kPi);
    EXPECT_NEAR(distance, 8.18 - pose.y, 0.06);
    EXPECT_EQ(occupancy, Occupancy::kOccupied);
  }
}

TEST_F(OccupancyGridTest, OriginAndRowsFollowTheWorld) {
  const ServedMap map = Serve(MakeGraph(Room()));
  EXPECT_LT(map.origin_x, -10.02);
  EXPECT_GT(map.origin_x, -10.02 - 1.0);
  EXPECT_LT(map.origin_y, 3.01);
  EXPECT_GT(map.origin_y, 3.01 - 1.0);
  EXPECT_EQ(map.At(-9.0, 3.01), Occupancy::kOccupied);  // lower side
  EXPECT_EQ(map.At(-9.0, 2.8), Occupancy::kUnknown);    // behind it
  EXPECT_EQ(map.At(-9.0, 3.2), Occupancy::kFree);
  EXPECT_EQ(map.At(-2.09, 7.0), Occupancy::kOccupied);  // right side
  EXPECT_EQ(map.At(-6.01, 7.0), Occupancy::kFree);      // over the end of the wall
}

// Whether a robot gets from one cell to another by its eight neighbours without touching a wall.
bool CanGo(const OccupancyGrid& grid, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const auto cell = [&grid](const Eigen::Vector2d& p) {
    return std::pair<int, int>(std::floor((p.x() - grid.left_m) / grid.resolution_m),
                               std::floor((p.y() - grid.bottom_m) / grid.resolution_m));
  };
  std::vector<bool> seen(grid.cells.size());
  std::queue<std::pair<int, int>> open;
  const auto visit = [&](int x, int y) {
    if (x < 0 || x >= grid.width || y < 0 || y >= grid.height) return;
    if (grid.At(x, y) == Occupancy::kOccupied || seen[y * grid.width + x]) return;
    seen[y * grid.width + x] = true;
    open.emplace(x, y);
  };
  visit(cell(from).first, cell(from).second);
  for (; !open.empty(); open.pop()) {
    const auto [x, y] = open.front();
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) visit(x + dx, y + dy);
    }
  }
  return seen[cell(to).second * grid.width + cell(to).first];
}

TEST_F(OccupancyGridTest, ThinWallsAreClosed) {
  const Eigen::Vector2d left(-9.0, 4.0), right(-3.0, 4.0), outside(-10.3, 4.0);
  for (const double resolution_m : {0.02, 0.05, 0.1}) {
    options_.resolution_m = resolution_m;
    SyntheticScene scene = Room();
    EXPECT_TRUE(CanGo(Build(MakeGraph(scene)), left, right));
    EXPECT_FALSE(CanGo(Build(MakeGraph(scene)), left, outside));
    for (Face& face : scene.faces) {  // Up to the ceiling.
      if (face.a.x() == -6.04 || face.a.x() == -5.98) face.b.y() = 8.18;
    }
    scene.faces.pop_back();
    EXPECT_FALSE(CanGo(Build(MakeGraph(scene)), left, right)) << resolution_m;
  }
}

TEST_F(OccupancyGridTest, WallsAreClosedWhereBeamsAreFartherApartThanCells) {
  SyntheticScene scene = Room();
  scene.laser = PanoramicLaser(240);  // 10 cm apart at 4 m
  EXPECT_TRUE(CanGo(Build(MakeGraph(scene)), {-9.0, 4.0}, {-3.0, 4.0}));
  EXPECT_FALSE(CanGo(Build(MakeGraph(scene)), {-9.0, 4.0}, {-10.3, 4.0}));
}

TEST_F(OccupancyGridTest, ALaserThatTurnsClockwiseSeesTheSame) {
  SyntheticScene scene = Room();
  scene.range_sigma_m = 0.0;
  const OccupancyGrid exact = Build(MakeGraph(scene));
  scene.laser.first_bearing_rad = scene.laser.Bearing(scene.laser.num_beams - 1);
  scene.laser.bearing_step_rad = -scene.laser.bearing_step_rad;
  const OccupancyGrid back = Build(MakeGraph(scene));
  ASSERT_EQ(back.cells.size(), exact.cells.size());
  int num_different = 0;
  for (std::size_t i = 0; i < back.cells.size(); ++i) {
    num_different += back.cells[i] != exact.cells[i];
  }
  EXPECT_LT(num_different, 0.001 * back.cells.size());
}

TEST_F(OccupancyGridTest, PeopleWhoPassDisappearAndFurnitureStays) {
  SyntheticScene scene = Room();
  scene.discs = {{{-7.2, 7.4}, 0.04}};  // the leg of a table
  const SlamGraph graph = MakeGraph(scene);
  MapState state = graph.InitialState();
  scene.discs.push_back({{-8.5, 5.6}, 0.2});
  scene.poses.resize(1);
  const MapState with_person = MakeGraph(scene).InitialState();
  const Eigen::Vector2d person(-8.5, 5.6);
  std::copy(with_person.points.begin(), with_person.points.end(), state.points.begin());
  const OccupancyGrid grid = Build(graph, state);
  const auto num_occupied = [&grid](const Eigen::Vector2d& center, double radius_m) {
    int count = 0;
    for (int y = 0; y < grid.height; ++y) {
      for (int x = 0; x < grid.width; ++x) {
        const Eigen::Vector2d cell(grid.left_m + (x + 0.5) * grid.resolution_m,
                                   grid.bottom_m + (y + 0.5) * grid.resolution_m);
        count += (cell - center).norm() < radius_m && grid.At(x, y) == Occupancy::kOccupied;
      }
    }
    return count;
  };
  EXPECT_EQ(num_occupied(person, 0.3), 0);
  EXPECT_GE(num_occupied({-7.2, 7.4}, 0.1), 1);
}

TEST_F(OccupancyGridTest, BeamsWithoutReturnTellNothing) {
  SyntheticScene scene = Room();
  scene.faces.erase(scene.faces.begin() + 1);  // The right side is of glass.
  scene.poses.resize(1);
  const OccupancyGrid grid = Build(MakeGraph(scene));
  const int row = static_cast<int>((scene.poses[0].y - grid.bottom_m) / 0.05);
  const int robot = static_cast<int>((scene.poses[0].x - grid.left_m) / 0.05);
  EXPECT_EQ(grid.At(robot, row + 2), Occupancy::kFree);
  SlamGraph blind;
  const int laser_id = blind.AddLaser(scene.laser);
  const int pose = blind.AddPose({0.0, 0.0, 0.0}, 0.0);
  blind.AddScan(pose, laser_id, std::vector<double>(720, 81.0));
  for (const Occupancy cell : Build(blind).cells) ASSERT_EQ(cell, Occupancy::kUnknown);
}

TEST_F(OccupancyGridTest, BeamsFarApartDoNotVouchForWhatIsBetween) {
  SyntheticScene scene;
  scene.faces = {{{5.0, -9.0}, {5.0, 9.0}}};
  scene.laser.num_beams = 2;
  scene.laser.first_bearing_rad = -0.2;
  scene.laser.bearing_step_rad = 0.4;
  scene.poses.assign(3, Pose2(0.0, 0.02, 0.0));
  const ServedMap map = Serve(MakeGraph(scene));
  EXPECT_EQ(map.At(0.5, 0.02), Occupancy::kFree);  // 0.2 m apart
  EXPECT_EQ(map.At(1.0, 0.02), Occupancy::kUnknown);
}

TEST_F(OccupancyGridTest, AStrayReturnIsNoObstacle) {
  const SlamGraph graph = MakeGraph(Room());
  MapState state = graph.InitialState();
  const double x = -11.0, y = 5.0;  // behind the wall, where nobody looks
  state.points[2 * 100] = x;
  state.points[2 * 100 + 1] = y;
  const ServedMap map = Serve(graph, state);
  EXPECT_EQ(map.At(x, y), Occupancy::kUnknown);
}

TEST_F(OccupancyGridTest, PointsThatAreNotFiniteAreLeftOut) {
  const SlamGraph graph = MakeGraph(Room());
  MapState state = graph.InitialState();
  const OccupancyGrid clean = Build(graph, state);
  state.points[2 * 50] = std::numeric_limits<double>::quiet_NaN();
  state.points[2 * 500 + 1] = std::numeric_limits<double>::infinity();
  const OccupancyGrid grid = Build(graph, state);
  EXPECT_NEAR(grid.width, clean.width, 3);
  EXPECT_NEAR(grid.height, clean.height, 3);
}

TEST_F(OccupancyGridTest, AGraphWithoutScansIsUnknownGround) {
  SlamGraph graph;
  graph.AddPose({7.0, 7.0, 0.0}, 0.0);
  const OccupancyGrid grid = Build(graph);
  EXPECT_EQ(grid.width, 20);  // half a metre around the pose
  for (const Occupancy cell : grid.cells) EXPECT_EQ(cell, Occupancy::kUnknown);
}

TEST_F(OccupancyGridTest, BadInputIsRefused) {
  EXPECT_THAT(ErrorOf(SlamGraph(), MapState()), HasSubstr("no poses"));
  const SlamGraph graph = MakeGraph(Room());
  MapState state = graph.InitialState();
  for (const double resolution_m : {0.0, -0.05, std::numeric_limits<double>::quiet_NaN(),
                                    std::numeric_limits<double>::infinity()}) {
    options_.resolution_m = resolution_m;
    EXPECT_THAT(ErrorOf(graph, state), HasSubstr("resolution_m = "));
  }
  options_ = OccupancyGridOptions();
  options_.max_cells = 1000;
  EXPECT_THAT(ErrorOf(graph, state), testing::AllOf(HasSubstr(" m in cells of 0.05 m"),
                                                    HasSubstr("more than 1000 cells")));
  options_ = OccupancyGridOptions();
  options_.coarsen_to_fit = true;
  state.poses[4] = 1e10;  // no map of anything
  EXPECT_THAT(ErrorOf(graph, state), HasSubstr("m from the origin"));
  options_ = OccupancyGridOptions();
  state.poses[4] = 1e8;
  EXPECT_THAT(ErrorOf(graph, state), HasSubstr("more than 4e+08 cells"));
  state.poses[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(ErrorOf(graph, state), HasSubstr("pose 1 is not finite"));
}

TEST_F(OccupancyGridTest, CoarsensOnlyAsFarAsItMust) {
  const SlamGraph graph = MakeGraph(Room(), 5);
  options_.coarsen_to_fit = true;
  EXPECT_EQ(Build(graph).resolution_m, 0.05);
  options_.max_cells = 10000;  // the room takes about 20,000 cells of 5 cm
  const OccupancyGrid grid = Build(graph);
  EXPECT_EQ(grid.resolution_m, 0.1);
  EXPECT_LE(grid.width * grid.height, 10000);
  EXPECT_GT(grid.width * grid.height, 2500);
  EXPECT_NEAR(grid.width * grid.resolution_m, 9.0, 0.5);
}

}  // namespace
}  // namespace plumbline
