#include "plumbline/apps/io/pose_graph_records.h"

namespace plumbline {
namespace {

constexpr PoseGraphDialect kDialects[] = {
    {PoseGraphFormat::kG2o, "VERTEX_SE2", "EDGE_SE2", {"I11", "I12", "I13", "I22", "I23", "I33"}},
    {PoseGraphFormat::kToro, "VERTEX2", "EDGE2", {"I11", "I12", "I22", "I33", "I13", "I23"}}};

}  // namespace

const PoseGraphDialect& DialectOf(PoseGraphFormat format) {
  return kDialects[format == PoseGraphFormat::kG2o ? 0 : 1];
}

const PoseGraphDialect* DialectOfKeyword(std::string_view keyword) {
  for (const PoseGraphDialect& dialect : kDialects) {
    if (keyword == dialect.vertex || keyword == dialect.edge) return &dialect;
  }
  return nullptr;
}

std::string_view RecordKeyword(std::string_view line) {
  const std::string_view word = FieldReader(line).Word("keyword");
  return word.substr(0, 1) == "#" ? std::string_view() : word;
}

Pose2 ReadPoseFields(FieldReader* fields) {
  Pose2 pose;
  pose.x = fields->Coordinate("x");
  pose.y = fields->Coordinate("y");
  pose.yaw = fields->Yaw("yaw");
  return pose;
}

}  // namespace plumbline
