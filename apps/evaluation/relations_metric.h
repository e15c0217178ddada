#ifndef PLUMBLINE_APPS_EVALUATION_RELATIONS_METRIC_H_
#define PLUMBLINE_APPS_EVALUATION_RELATIONS_METRIC_H_

#include <string>
#include <vector>

#include "plumbline/apps/evaluation/pose_errors.h"
#include "plumbline/apps/io/trajectory_io.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A true relative pose of the robot between two times.
struct Relation {
  double from_s = 0.0;
  double to_s = 0.0;
  Pose2 from_from_to;
};

/// Reads the Freiburg SLAM benchmark's lines `t1 t2 x y z roll pitch yaw` (the pose at t2 seen from
/// t1, [s], [m], [rad]), plain or gzip-compressed; empty lines and comments (#) are skipped, z,
/// roll and pitch dropped. NotFound or InvalidArgument if the file cannot be read, DataLoss if it
/// is truncated or corrupt; InvalidArgument, naming file, line and field, on anything else, and if
/// there is no relation.
Status ReadRelations(const std::string& path, std::vector<Relation>* relations);

struct RelationsOptions {
  /// A pose stands for a relation's time within this time [s], up to an hour.
  double tolerance_s = 0.05;
  /// Relations that span no more than this time [s] are local, the others revisits. Odometry alone
  /// does well in local ones. Up to 1e12, as times are.
  double local_span_s = 10.0;

  bool Check(std::string* error) const;
};

struct RelationsMetric {
  PoseErrorStatistics all, local, revisits;
};

/// Error of the trajectory's relative poses against the true ones, as in Kuemmerle, Steder,
/// Dornhege, Ruhnke, Grisetti, Stachniss, Kleiner: On measuring the accuracy of SLAM algorithms
/// (2009), whose figure is mean and std. Relations without a pose at both times are left out and
/// counted.
RelationsMetric MeasureRelations(const std::vector<Relation>& relations,
                                 const std::vector<TimedPose>& trajectory,
                                 const RelationsOptions& options);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_EVALUATION_RELATIONS_METRIC_H_
