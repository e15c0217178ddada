#include "plumbline/apps/simulation/floor.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "plumbline/apps/simulation/floor_plan.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/core/angle.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

// Streams of random numbers: the simulator has 0 and 1, the style of the floor 2.
constexpr std::uint32_t kRouteStream = 3, kCorridorStream = 4, kRoomStream = 100;

// Share of the furniture that moves from one visit to another.
constexpr double kMovedShare = 1.0 / 3.0;

constexpr double kOuterWall = 0.3, kPartition = 0.1;
// Free space on either side of the robot's path: its radius, the width that it cuts off in a curve,
// and a little.
constexpr double kPathMargin = 0.45;
// From the corridor's wall into a room, until the robot turns to its middle.
constexpr double kEntrance = 1.0;
// A door keeps this distance from the partitions.
constexpr double kDoorMargin = 0.15;

// Rooms side by side, and the wall between them and their corridor.
struct Row {
  double west, east;       // x of both ends
  double front_y, back_y;  // walls: to the corridor, and opposite
  int corridor;            // 0: southern, 1: northern

  // A point `along` the x axis and `inside` from the corridor's wall; negative is in the corridor.
  Vector2d At(double along, double inside) const {
    return {along, front_y + (back_y > front_y ? inside : -inside)};
  }
  double depth() const { return std::abs(back_y - front_y); }
};

struct Room {
  Row row;
  double west, east;  // x between which it has its full depth
  double door_x;
  NoiseSource source;  // for all that is in it
};

// Where a cross corridor, counted from the west, meets the southern or northern corridor.
struct Crossing {
  int column, corridor;

  bool operator<(const Crossing& other) const {
    return std::pair(column, corridor) < std::pair(other.column, other.corridor);
  }
};

double LengthOf(const std::vector<Vector2d>& polyline) {
  double length = 0.0;
  for (std::size_t i = 1; i < polyline.size(); ++i) {
    length += (polyline[i] - polyline[i - 1]).norm();
  }
  return length;
}

// Distance from a point to a rectangle around the origin of its frame.
double DistanceToBox(const Vector2d& point_in_box, const Vector2d& size) {
  return (point_in_box.cwiseAbs() - 0.5 * size).cwiseMax(0.0).norm();
}

class FloorBuilder {
 public:
  FloorBuilder(const FloorStyle& style, std::uint64_t seed) : style_(style), seed_(seed) {
    LayOut();
  }

  Building Build() {
    DrawWalls();
    for (const Row& row : rows_) DrawRooms(row);
    std::uint32_t stream = kRoomStream;
    for (Room& room : rooms_) {
      NoiseSource moved(SeedOfVisit(seed_, style_.visit), stream++);
      FurnishRoom(&room, &moved);
    }
    NoiseSource source(seed_, kCorridorStream);
    NoiseSource moved(SeedOfVisit(seed_, style_.visit), kCorridorStream);
    for (const Row& row : rows_) FurnishCorridor(row, &source, &moved);
    Building building;
    plan_.Furnish(&building);
    for (const Vector2d& point : Route()) {
      building.path.push_back({point, building.path.size() + 1});
    }
    return building;
  }

 private:
  void LayOut();
  void DrawWalls();
  void DrawRooms(const Row& row);
  void AddRoom(Room room);
  // moved: says what another visit moves, and where to.
  void FurnishRoom(Room* room, NoiseSource* moved);
  void FurnishCorridor(const Row& row, NoiseSource* source, NoiseSource* moved);
  bool IsMoved(NoiseSource* moved) const {
    return style_.visit != 0 && moved->Uniform() < kMovedShare;
  }
  // A piece of furniture, if it is in nobody's way.
  void PutBox(const Pose2& world_from_box, const Vector2d& size);
  void PutDisc(const Vector2d& center, double radius_m);
  bool IsFree(const Pose2& world_from_box, const Vector2d& size) const;

  // From the corridor into the room and to its middle.
  std::vector<Vector2d> WayIn(const Room& room) const;
  void KeepClear(const Vector2d& from, const Vector2d& to);
  Vector2d PositionOf(const Crossing& crossing) const {
    return {cross_x_[crossing.column], corridor_y_[crossing.corridor]};
  }
  std::vector<Crossing> Tour() const;
  Crossing NextCrossing(const Crossing& last, const Crossing& current, NoiseSource* source) const;
  std::vector<Vector2d> Route() const;
  void VisitRoom(const Vector2d& from, const Vector2d& to, int corridor, NoiseSource* source,
                 std::vector<Vector2d>* route) const;

  const FloorStyle& style_;
  const std::uint64_t seed_;
  double width_m_ = 0.0, depth_m_ = 0.0;
  double corridor_y_[2] = {};    // centre lines
  std::vector<double> cross_x_;  // of the cross corridors, likewise
  std::vector<Row> rows_;
  std::vector<Room> rooms_;
  FloorPlan plan_;
  std::vector<Vector2d> path_points_;                // of all ways that the robot might take
  std::vector<std::pair<Vector2d, double>> pieces_;  // furniture: centre, radius
};

void FloorBuilder::LayOut() {
  const double* depths = style_.row_depths_m;
  const double south_front = depths[0], south_block = south_front + style_.corridor_width_m;
  const double south_back = south_block + depths[1], north_back = south_back + style_.core_depth_m;
  const double north_block = north_back + depths[2];
  const double north_front = north_block + style_.corridor_width_m;
  depth_m_ = north_front + depths[3];
  corridor_y_[0] = 0.5 * (south_front + south_block);
  corridor_y_[1] = 0.5 * (north_block + north_front);
  for (const double block : style_.block_widths_m) {
    if (width_m_ > 0.0) {
      cross_x_.push_back(width_m_ + 0.5 * style_.cross_corridor_width_m);
      width_m_ += style_.cross_corridor_width_m;
    }
    rows_.push_back({width_m_, width_m_ + block, south_block, south_back, 0});
    rows_.push_back({width_m_, width_m_ + block, north_block, north_back, 1});
    width_m_ += block;
  }
  rows_.push_back({0.0, width_m_, south_front, 0.0, 0});
  rows_.push_back({0.0, width_m_, north_front, depth_m_, 1});
  for (const double x : cross_x_) KeepClear({x, corridor_y_[0]}, {x, corridor_y_[1]});
  for (const double y : corridor_y_) KeepClear({0.0, y}, {width_m_, y});
}

void FloorBuilder::DrawWalls() {
  plan_.AddRoom({0.0, 0.0}, {width_m_, depth_m_}, kOuterWall);
  for (const Row& row : rows_) {
    plan_.AddWall({row.west, row.front_y}, {row.east, row.front_y}, style_.corridor_wall_m);
    // The outer rows end at the building's own walls.
    if (row.back_y == 0.0 || row.back_y == depth_m_) continue;
    const bool shares_wall = style_.core_depth_m == 0.0 && row.corridor == 1;
    if (!shares_wall) plan_.AddWall({row.west, row.back_y}, {row.east, row.back_y}, kPartition);
    // The side of a block is drawn from both of its rows.
    const double middle_y = row.back_y + (row.corridor == 0 ? 0.5 : -0.5) * style_.core_depth_m;
    for (const double x : {row.west, row.east}) {
      if (x == 0.0 || x == width_m_) continue;
      plan_.AddWall({x, row.front_y}, {x, middle_y}, style_.corridor_wall_m);
    }
  }
}

void FloorBuilder::DrawRooms(const Row& row) {
  const int num_rooms =
      std::max(1, static_cast<int>(std::round((row.east - row.west) / style_.room_width_m)));
  const double mean_width = (row.east - row.west) / num_rooms;
  double west = row.west, west_bend = 0.0;
  for (int i = 0; i < num_rooms; ++i) {
    const auto index = static_cast<std::uint32_t>(rooms_.size());
    NoiseSource source(seed_, kRoomStream + (style_.irregularity > 0.0 ? index : 0));
    // The partition to the next room, which one in three bends at its far end.
    const double shift = style_.irregularity * 0.4 * (source.Uniform() - 0.5) * mean_width;
    const bool bends = source.Uniform() < style_.slant / 3.0;
    const bool last = i + 1 == num_rooms;
    const double bend = bends && !last ? source.Uniform() - 0.5 : 0.0;
    const double east = last ? row.east : row.west + (i + 1) * mean_width + shift;
    if (!last) {
      plan_.AddWall(row.At(east, 0.0), row.At(east + bend, row.depth()), kPartition);
    }
    AddRoom({row, west + std::max(0.0, west_bend), east + std::min(0.0, bend), 0.0, source});
    west = east;
    west_bend = bend;
  }
}

// With its door, and a way into it that stays clear.
void FloorBuilder::AddRoom(Room room) {
  const double slack = room.east - room.west - style_.door_width_m - 2.0 * kDoorMargin;
  room.door_x = 0.5 * (room.west + room.east) +
                style_.irregularity * (room.source.Uniform() - 0.5) * std::max(0.0, slack);
  const double half_door = 0.5 * style_.door_width_m;
  plan_.CutDoor(room.row.At(room.door_x - half_door, 0.0),
                room.row.At(room.door_x + half_door, 0.0));
  const std::vector<Vector2d> way = WayIn(room);
  for (std::size_t i = 1; i < way.size(); ++i) KeepClear(way[i - 1], way[i]);
  rooms_.push_back(room);
}

void FloorBuilder::FurnishRoom(Room* room, NoiseSource* moved) {
  NoiseSource& source = room->source;
  const Row& row = room->row;
  const double free_width = room->east - room->west - kPartition;
  const double free_depth = row.depth() - kPartition;
  const Vector2d middle = row.At(0.5 * (room->west + room->east), 0.5 * row.depth());
  for (int i = 0; i < style_.furniture_per_room; ++i) {
    // A table in the room, or a desk or cabinet with its back to one of three walls.
    const double kind = source.Uniform();
    double along = source.Uniform() - 0.5;
    const double length = 0.7 + 1.1 * source.Uniform(), depth = 0.4 + 0.4 * source.Uniform();
    double turn = source.Uniform() - 0.5;
    if (IsMoved(moved)) {
      along = moved->Uniform() - 0.5;
      turn = moved->Uniform() - 0.5;
    }
    const Vector2d size(length, depth);
    const double far = row.back_y > row.front_y ? 1.0 : -1.0;
    if (kind < 0.2) {
      const Vector2d center =
          middle + Vector2d(0.5 * free_width * turn, 0.5 * free_depth * along * far);
      PutDisc(center, (0.25 + 0.5 * std::abs(along)) * depth);
    } else if (kind < 0.6) {
      const double y = middle.y() + far * 0.5 * (free_depth - depth);
      PutBox({middle.x() + along * (free_width - length), y, 0.0}, size);
    } else {
      const double side = kind < 0.8 ? -1.0 : 1.0;
      const double lean = style_.slant * 0.2 * std::max(0.0, std::abs(turn) - 0.3);
      PutBox({middle.x() + side * 0.5 * (free_width - depth - 0.1),
              middle.y() + far * along * (free_depth - length), 0.5 * kPi + lean},
             size);
    }
  }
}

void FloorBuilder::FurnishCorridor(const Row& row, NoiseSource* source, NoiseSource* moved) {
  const double length = row.east - row.west;
  const int num_pieces = static_cast<int>(std::round(length * style_.furniture_per_corridor_m));
  for (int i = 0; i < num_pieces; ++i) {
    const double width = 0.5 + 1.1 * source->Uniform(), depth = 0.25 + 0.15 * source->Uniform();
    double along = row.west + 0.5 * width + source->Uniform() * (length - width);
    const bool is_pillar = source->Uniform() < 0.3;
    if (!is_pillar && IsMoved(moved)) {
      along = row.west + 0.5 * width + moved->Uniform() * (length - width);
    }
    if (is_pillar) {  // a pillar, half in the wall
      PutDisc(row.At(along, 0.0), 0.5 * depth + 0.05);
    } else {
      const Vector2d center = row.At(along, -0.5 * (style_.corridor_wall_m + depth));
      PutBox({center.x(), center.y(), 0.0}, {width, depth});
    }
  }
}

bool FloorBuilder::IsFree(const Pose2& world_from_box, const Vector2d& size) const {
  for (const auto& [center, radius] : pieces_) {
    if ((center - world_from_box.translation()).norm() < radius + 0.5 * size.norm()) return false;
  }
  const Pose2 box_from_world = world_from_box.Inverse();
  // Most points of a large floor are too far away to be looked at closely.
  const double reach = 0.5 * size.norm() + kPathMargin + FloorPlan::kMinLength;
  const Vector2d center = world_from_box.translation();
  return std::none_of(path_points_.begin(), path_points_.end(), [&](const Vector2d& point) {
    return (point - center).squaredNorm() < reach * reach &&
           DistanceToBox(box_from_world * point, size) < kPathMargin;
  });
}

void FloorBuilder::PutBox(const Pose2& world_from_box, const Vector2d& size) {
  if (!IsFree(world_from_box, size)) return;
  plan_.AddBox(world_from_box, size);
  pieces_.push_back({world_from_box.translation(), 0.5 * size.norm()});
}

void FloorBuilder::PutDisc(const Vector2d& center, double radius_m) {
  if (!IsFree({center.x(), center.y(), 0.0}, Vector2d::Constant(2.0 * radius_m))) return;
  plan_.AddDisc(center, radius_m);
  pieces_.push_back({center, radius_m});
}

std::vector<Vector2d> FloorBuilder::WayIn(const Room& room) const {
  const Row& row = room.row;
  std::vector<Vector2d> way = {{room.door_x, corridor_y_[row.corridor]}};
  if (row.depth() < 2.0 * kEntrance) return way;  // a niche
  way.push_back(row.At(room.door_x, kEntrance));
  way.push_back(row.At(0.5 * (room.west + room.east), 0.6 * row.depth()));
  return way;
}

void FloorBuilder::KeepClear(const Vector2d& from, const Vector2d& to) {
  constexpr double kSpacing = 0.1;
  const int num_steps = static_cast<int>(std::ceil((to - from).norm() / kSpacing));
  for (int i = 0; i <= num_steps; ++i) {
    path_points_.push_back(from + (to - from) * i / std::max(1, num_steps));
  }
}

// Walks from crossing to crossing and never turns back, so that it closes loops again and again.
std::vector<Vector2d> FloorBuilder::Route() const {
  NoiseSource source(SeedOfVisit(seed_, style_.visit), kRouteStream);
  std::vector<Vector2d> route = {{1.0, corridor_y_[0]}};
  std::set<Crossing> visited;
  Crossing last = {-1, 0}, current = {0, 0};
  if (style_.visit != 0) {
    route.clear();
    current.column = static_cast<int>(source.Uniform() * static_cast<double>(cross_x_.size()));
    current.corridor = source.Uniform() < 0.5 ? 0 : 1;
  }
  bool closed = false;
  const std::vector<Crossing> tour = Tour();
  std::size_t num_legs = 0;
  while (!closed || LengthOf(route) < style_.drive_length_m) {
    const Vector2d position = PositionOf(current);
    if (last.column >= 0 && last.corridor == current.corridor) {
      VisitRoom(route.back(), position, current.corridor, &source, &route);
    }
    route.push_back(position);
    closed = !visited.insert(current).second || closed;
    const Crossing next = style_.route == RouteKind::kTour ? tour[++num_legs % tour.size()]
                                                           : NextCrossing(last, current, &source);
    last = current;
    current = next;
  }
  return route;
}

// One round, from the south-western crossing to the last one before it.
std::vector<Crossing> FloorBuilder::Tour() const {
  std::vector<Crossing> tour;
  const int last = static_cast<int>(cross_x_.size()) - 1;
  for (int column = 0; column < last; ++column) {
    tour.insert(tour.end(),
                {{column, 0}, {column + 1, 0}, {column + 1, 1}, {column, 1}, {column, 0}});
  }
  tour.push_back({last, 0});
  for (int column = last; column >= 0; --column) tour.push_back({column, 1});
  return tour;
}

Crossing FloorBuilder::NextCrossing(const Crossing& last, const Crossing& current,
                                    NoiseSource* source) const {
  std::vector<Crossing> next;
  for (const Crossing& neighbor : {Crossing{current.column - 1, current.corridor},
                                   Crossing{current.column + 1, current.corridor},
                                   Crossing{current.column, 1 - current.corridor}}) {
    const bool exists = neighbor.column >= 0 && neighbor.column < static_cast<int>(cross_x_.size());
    if (exists && (neighbor < last || last < neighbor)) next.push_back(neighbor);
  }
  return next[static_cast<std::size_t>(source->Uniform() * next.size())];
}

// On the way from one crossing to the next along a corridor: perhaps into a room, and back.
void FloorBuilder::VisitRoom(const Vector2d& from, const Vector2d& to, int corridor,
                             NoiseSource* source, std::vector<Vector2d>* route) const {
  constexpr double kFromCrossing = 1.0;  // [m], so that two curves do not meet
  std::vector<const Room*> candidates;
  for (const Room& room : rooms_) {
    if (room.row.corridor == corridor && room.door_x > std::min(from.x(), to.x()) + kFromCrossing &&
        room.door_x < std::max(from.x(), to.x()) - kFromCrossing) {
      candidates.push_back(&room);
    }
  }
  const double decision = source->Uniform(), choice = source->Uniform();
  if (candidates.empty() || decision >= style_.visit_probability) return;
  const std::vector<Vector2d> way =
      WayIn(*candidates[static_cast<std::size_t>(choice * candidates.size())]);
  route->insert(route->end(), way.begin(), way.end());
  route->insert(route->end(), way.rbegin() + 1, way.rend());
}

}  // namespace

std::uint64_t SeedOfVisit(std::uint64_t seed, std::uint64_t visit) {
  return seed + visit * 0x9e3779b97f4a7c15ULL;
}

Building MakeFloor(const FloorStyle& style, std::uint64_t seed) {
  return FloorBuilder(style, seed).Build();
}

}  // namespace plumbline
