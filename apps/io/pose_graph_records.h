#ifndef PLUMBLINE_APPS_IO_POSE_GRAPH_RECORDS_H_
#define PLUMBLINE_APPS_IO_POSE_GRAPH_RECORDS_H_

#include <string_view>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/pose_graph_file.h"
#include "plumbline/core/pose2.h"

namespace plumbline {

/// How one format of pose graphs names and orders what reader and writer have to agree on.
struct PoseGraphDialect {
  PoseGraphFormat format;
  const char* vertex;
  const char* edge;
  const char* information[6];  ///< "I" row column, both from 1
};

const PoseGraphDialect& DialectOf(PoseGraphFormat format);

/// Null if the keyword is that of no format's vertices or edges.
const PoseGraphDialect* DialectOfKeyword(std::string_view keyword);

/// The first word of a line; empty for comments and blank lines.
std::string_view RecordKeyword(std::string_view line);

/// The three fields x y yaw.
Pose2 ReadPoseFields(FieldReader* fields);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_POSE_GRAPH_RECORDS_H_
