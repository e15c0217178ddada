#include "plumbline/apps/simulation/building_reader.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/text_reader.h"
#include "plumbline/core/pose2.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

constexpr double kDefaultThickness = 0.1;
// How far a door may lie beside the centre line of the wall that it opens: what rounding to
// centimetres does to the coordinates of a slanted wall.
constexpr double kDoorTolerance = 0.01;
// Two points closer than this are one.
constexpr double kMinLength = 1e-6;

struct Wall {
  Vector2d a, b;  // of the centre line
  double half_thickness_m;
  // How far the bar reaches beyond a and b.
  double overhang_a_m, overhang_b_m;
};

struct Door {
  Vector2d a, b;
  std::size_t line;
};

// What has been read so far. Doors wait for the end of the file: they open every wall.
struct Draft {
  double thickness_m = kDefaultThickness;
  std::vector<Wall> walls;
  std::vector<Door> doors;
  Building building;
};

Vector2d ReadPoint(FieldReader* fields, const char* x_name, const char* y_name) {
  const double x = fields->FiniteNumber(x_name);
  return {x, fields->FiniteNumber(y_name)};
}

void ReadSegment(FieldReader* fields, Vector2d* a, Vector2d* b) {
  *a = ReadPoint(fields, "x1", "y1");
  *b = ReadPoint(fields, "x2", "y2");
  if ((*b - *a).norm() < kMinLength) fields->Fail("x2", "both ends are the same point");
}

void AddWall(const Vector2d& a, const Vector2d& b, Draft* draft) {
  const double half = 0.5 * draft->thickness_m;
  draft->walls.push_back({a, b, half, half, half});
}

void ReadRoom(FieldReader* fields, Draft* draft) {
  Vector2d a, c;
  ReadSegment(fields, &a, &c);
  if ((c - a).cwiseAbs().minCoeff() < kMinLength) {
    fields->Fail("x2", "a room needs two corners that differ in x and in y");
  }
  const Vector2d b(c.x(), a.y()), d(a.x(), c.y());
  AddWall(a, b, draft);
  AddWall(b, c, draft);
  AddWall(c, d, draft);
  AddWall(d, a, draft);
}

// A rectangle whose sides run from -low to high along the axes of a frame.
void AddRectangle(const Pose2& world_from_frame, const Vector2d& low, const Vector2d& high,
                  std::vector<Face>* faces) {
  const Vector2d corners[] = {
      world_from_frame * low, world_from_frame * Vector2d(high.x(), low.y()),
      world_from_frame * high, world_from_frame * Vector2d(low.x(), high.y())};
  for (int i = 0; i < 4; ++i) faces->push_back({corners[i], corners[(i + 1) % 4]});
}

void ReadBox(FieldReader* fields, Draft* draft) {
  const Vector2d center = ReadPoint(fields, "x", "y");
  const double width = fields->PositiveNumber("width");
  const double depth = fields->PositiveNumber("depth");
  const Pose2 world_from_box(center.x(), center.y(), DegToRad(fields->FiniteNumber("yaw")));
  const Vector2d half(0.5 * width, 0.5 * depth);
  AddRectangle(world_from_box, -half, half, &draft->building.faces);
}

void ReadCircle(FieldReader* fields, Draft* draft) {
  const Vector2d center = ReadPoint(fields, "x", "y");
  draft->building.discs.push_back({center, fields->PositiveNumber("radius")});
}

void ReadWaypoint(FieldReader* fields, std::size_t line, Draft* draft) {
  const Vector2d position = ReadPoint(fields, "x", "y");
  std::vector<Waypoint>& path = draft->building.path;
  if (!path.empty() && (position - path.back().position).norm() < kMinLength) {
    fields->Fail("x", "the same point as the one before");
  }
  path.push_back({position, line});
}

// Returns the error in `text`, empty if there is none.
std::string ReadRecord(std::string_view text, std::size_t line, Draft* draft) {
  FieldReader fields(text);
  const std::string keyword(fields.Word("keyword"));
  if (keyword == "thickness") {
    draft->thickness_m = fields.PositiveNumber("t");
  } else if (keyword == "wall") {
    Vector2d a, b;
    ReadSegment(&fields, &a, &b);
    AddWall(a, b, draft);
  } else if (keyword == "room") {
    ReadRoom(&fields, draft);
  } else if (keyword == "door") {
    Door door{{}, {}, line};
    ReadSegment(&fields, &door.a, &door.b);
    draft->doors.push_back(door);
  } else if (keyword == "box") {
    ReadBox(&fields, draft);
  } else if (keyword == "circle") {
    ReadCircle(&fields, draft);
  } else if (keyword == "path") {
    ReadWaypoint(&fields, line, draft);
  } else {
    return "unknown keyword '" + keyword + "'";
  }
  fields.ExpectEnd();
  return fields.ok() ? "" : keyword + " " + fields.error();
}

// Replaces a wall by what a door leaves of it. Returns whether the door lies in the wall.
bool CutWall(const Door& door, const Wall& wall, std::vector<Wall>* rest) {
  const double length = (wall.b - wall.a).norm();
  const Vector2d along = (wall.b - wall.a) / length;
  const Vector2d across(-along.y(), along.x());
  const Vector2d to_a = door.a - wall.a, to_b = door.b - wall.a;
  const double begin = std::min(to_a.dot(along), to_b.dot(along));
  const double end = std::max(to_a.dot(along), to_b.dot(along));
  const bool opens = std::abs(to_a.dot(across)) <= kDoorTolerance &&
                     std::abs(to_b.dot(across)) <= kDoorTolerance &&
                     std::min(end, length) - std::max(begin, 0.0) > kMinLength;
  if (!opens) {
    rest->push_back(wall);
    return false;
  }
  if (begin > kMinLength) {
    rest->push_back(
        {wall.a, wall.a + begin * along, wall.half_thickness_m, wall.overhang_a_m, 0.0});
  }
  if (end < length - kMinLength) {
    rest->push_back({wall.a + end * along, wall.b, wall.half_thickness_m, 0.0, wall.overhang_b_m});
  }
  return true;
}

bool CutDoor(const Door& door, std::vector<Wall>* walls) {
  std::vector<Wall> rest;
  bool opened = false;
  for (const Wall& wall : *walls) opened = CutWall(door, wall, &rest) || opened;
  *walls = std::move(rest);
  return opened;
}

void AddFaces(const Wall& wall, std::vector<Face>* faces) {
  const Vector2d along = wall.b - wall.a;
  const Pose2 world_from_wall(wall.a.x(), wall.a.y(), std::atan2(along.y(), along.x()));
  AddRectangle(world_from_wall, {-wall.overhang_a_m, -wall.half_thickness_m},
               {along.norm() + wall.overhang_b_m, wall.half_thickness_m}, faces);
}

Status Finish(const std::string& path, Draft* draft) {
  for (const Door& door : draft->doors) {
    if (CutDoor(door, &draft->walls)) continue;
    return Status::InvalidArgument(path + ":" + std::to_string(door.line) +
                                   ": door: no wall runs along this segment");
  }
  Building& building = draft->building;
  for (const Wall& wall : draft->walls) AddFaces(wall, &building.faces);
  if (building.faces.empty() && building.discs.empty()) {
    return Status::InvalidArgument(path + ": no wall, room, box or circle");
  }
  if (building.path.size() == 1) {
    return Status::InvalidArgument(path + ":" + std::to_string(building.path[0].line) +
                                   ": path: a path needs at least two points");
  }
  building.name = path;
  return Status::Ok();
}

}  // namespace

Status ReadBuilding(const std::string& path, Building* building) {
  TextReader reader;
  PLUMBLINE_RETURN_IF_ERROR(reader.Open(path));
  Draft draft;
  std::string_view line;
  while (reader.NextLine(&line)) {
    const std::string_view record = line.substr(0, line.find('#'));
    if (record.find_first_not_of(" \t") == record.npos) continue;
    const std::string error = ReadRecord(record, reader.line_number(), &draft);
    if (!error.empty()) {
      return Status::InvalidArgument(path + ":" + std::to_string(reader.line_number()) + ": " +
                                     error);
    }
  }
  PLUMBLINE_RETURN_IF_ERROR(reader.status());
  if (reader.truncated()) return Status::DataLoss(path + ": the compressed file is truncated");
  PLUMBLINE_RETURN_IF_ERROR(Finish(path, &draft));
  *building = std::move(draft.building);
  return Status::Ok();
}

}  // namespace plumbline
