#include "plumbline/apps/simulation/building_reader.h"

#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/text_reader.h"
#include "plumbline/apps/simulation/floor_plan.h"
#include "plumbline/core/pose2.h"

namespace plumbline {
namespace {

using Eigen::Vector2d;

constexpr double kDefaultThickness = 0.1;
constexpr double kMaxLength = 1e5;

struct Door {
  Vector2d a, b;
  std::size_t line;
};

// What has been read so far. Doors wait for the end of the file: they open every wall.
struct Draft {
  double thickness_m = kDefaultThickness;
  FloorPlan plan;
  std::vector<Door> doors;
  std::vector<Waypoint> path;
};

double ReadLength(FieldReader* fields, const char* name) {
  const double length = fields->FiniteNumber(name);
  if (std::abs(length) > kMaxLength) fields->Fail(name, "is beyond 1e5 m");
  return length;
}

double ReadSize(FieldReader* fields, const char* name) {
  const double size = fields->PositiveNumber(name);
  if (size > kMaxLength) fields->Fail(name, "is beyond 1e5 m");
  if (size < FloorPlan::kMinLength) fields->Fail(name, "is too small");
  return size;
}

Vector2d ReadPoint(FieldReader* fields, const char* x_name, const char* y_name) {
  const double x = ReadLength(fields, x_name);
  return {x, ReadLength(fields, y_name)};
}

void ReadSegment(FieldReader* fields, Vector2d* a, Vector2d* b) {
  *a = ReadPoint(fields, "x1", "y1");
  *b = ReadPoint(fields, "x2", "y2");
  if ((*b - *a).norm() < FloorPlan::kMinLength) fields->Fail("x2", "both ends are the same point");
}

void ReadRoom(FieldReader* fields, Draft* draft) {
  Vector2d a, c;
  ReadSegment(fields, &a, &c);
  if ((c - a).cwiseAbs().minCoeff() < FloorPlan::kMinLength) {
    fields->Fail("x2", "a room needs two corners that differ in x and in y");
  }
  draft->plan.AddRoom(a, c, draft->thickness_m);
}

void ReadBox(FieldReader* fields, Draft* draft) {
  const Vector2d center = ReadPoint(fields, "x", "y");
  const double width = ReadSize(fields, "width");
  const double depth = ReadSize(fields, "depth");
  const Pose2 world_from_box(center.x(), center.y(), DegToRad(fields->Yaw("yaw")));
  draft->plan.AddBox(world_from_box, {width, depth});
}

void ReadCircle(FieldReader* fields, Draft* draft) {
  const Vector2d center = ReadPoint(fields, "x", "y");
  draft->plan.AddDisc(center, ReadSize(fields, "radius"));
}

void ReadWaypoint(FieldReader* fields, std::size_t line, Draft* draft) {
  const Vector2d position = ReadPoint(fields, "x", "y");
  std::vector<Waypoint>& path = draft->path;
  if (!path.empty() && (position - path.back().position).norm() < FloorPlan::kMinLength) {
    fields->Fail("x", "the same point as the one before");
  }
  path.push_back({position, line});
}

// Returns the error in `text`, empty if there is none.
std::string ReadRecord(std::string_view text, std::size_t line, Draft* draft) {
  FieldReader fields(text);
  const std::string keyword(fields.Word("keyword"));
  if (keyword == "thickness") {
    draft->thickness_m = ReadSize(&fields, "t");
  } else if (keyword == "wall") {
    Vector2d a, b;
    ReadSegment(&fields, &a, &b);
    draft->plan.AddWall(a, b, draft->thickness_m);
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
    return "unknown keyword " + Quote(keyword);
  }
  fields.ExpectEnd();
  return fields.ok() ? "" : keyword + " " + fields.error();
}

Status Finish(const std::string& path, Draft* draft, Building* building) {
  for (const Door& door : draft->doors) {
    if (draft->plan.CutDoor(door.a, door.b)) continue;
    return Status::InvalidArgument(path + ":" + std::to_string(door.line) +
                                   ": door: no wall runs along this segment");
  }
  if (draft->plan.empty()) {
    return Status::InvalidArgument(path + ": no wall, room, box or circle");
  }
  if (draft->path.size() == 1) {
    return Status::InvalidArgument(path + ":" + std::to_string(draft->path[0].line) +
                                   ": path: a path needs at least two points");
  }
  building->name = path;
  building->path = std::move(draft->path);
  draft->plan.Furnish(building);
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
  PLUMBLINE_RETURN_IF_ERROR(reader.CheckWhole());
  return Finish(path, &draft, building);
}

}  // namespace plumbline
