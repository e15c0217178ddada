#include "plumbline/apps/evaluation/relations_metric.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/pose_timeline.h"
#include "plumbline/apps/io/text_reader.h"
#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

Relation ReadRelation(FieldReader* fields) {
  Relation relation;
  relation.from_s = fields->Time("t1");
  relation.to_s = fields->Time("t2");
  relation.from_from_to.x = fields->Coordinate("x");
  relation.from_from_to.y = fields->Coordinate("y");
  for (const char* field : {"z", "roll", "pitch"}) fields->FiniteNumber(field);
  relation.from_from_to.yaw = fields->Yaw("yaw");
  fields->ExpectEnd();
  return relation;
}

}  // namespace

Status ReadRelations(const std::string& path, std::vector<Relation>* relations) {
  TextReader reader;
  PLUMBLINE_RETURN_IF_ERROR(reader.Open(path));
  std::vector<Relation> result;
  std::string_view line;
  while (reader.NextLine(&line)) {
    const std::size_t first = line.find_first_not_of(" \t");
    if (first == line.npos || line[first] == '#') continue;
    FieldReader fields(line);
    result.push_back(ReadRelation(&fields));
    if (!fields.ok()) {
      return Status::InvalidArgument(path + ":" + std::to_string(reader.line_number()) + ": " +
                                     fields.error());
    }
  }
  PLUMBLINE_RETURN_IF_ERROR(reader.CheckWhole());
  if (result.empty()) return Status::InvalidArgument(path + ": no relation");
  *relations = std::move(result);
  return Status::Ok();
}

bool RelationsOptions::Check(std::string* error) const {
  PLUMBLINE_CHECK_OPTION_WITHIN(tolerance_s, 0.0, 3600.0);
  PLUMBLINE_CHECK_OPTION_WITHIN(local_span_s, 0.0, 1e12);
  return true;
}

RelationsMetric MeasureRelations(const std::vector<Relation>& relations,
                                 const std::vector<TimedPose>& trajectory,
                                 const RelationsOptions& options) {
  const PoseTimeline timeline(trajectory);
  PoseErrors all(StatisticsConvention::kFreiburg), local = all, revisits = all;
  for (const Relation& relation : relations) {
    const bool is_local = std::abs(relation.to_s - relation.from_s) <= options.local_span_s;
    const TimedPose* from = timeline.Nearest(relation.from_s, options.tolerance_s);
    const TimedPose* to = timeline.Nearest(relation.to_s, options.tolerance_s);
    for (PoseErrors* errors : {&all, is_local ? &local : &revisits}) {
      if (from == nullptr || to == nullptr) {
        errors->AddUnmatched();
      } else {
        errors->Add(relation.from_from_to, Between(from->world_from_robot, to->world_from_robot));
      }
    }
  }
  return {all.Statistics(), local.Statistics(), revisits.Statistics()};
}

}  // namespace plumbline
