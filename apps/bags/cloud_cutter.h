#ifndef PLUMBLINE_APPS_BAGS_CLOUD_CUTTER_H_
#define PLUMBLINE_APPS_BAGS_CLOUD_CUTTER_H_

#include <optional>
#include <string>

#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/apps/io/ros_recording.h"

namespace plumbline {

/// Heights [m] along the z axis of a cloud's frame.
struct HeightBand {
  double low_m = 0.0;
  double high_m = 0.0;

  /// False if a height is not finite or the band is empty; *error, if not null, then says so.
  bool Check(std::string* error) const;
};

/// Turns point clouds of one laser, each a full sweep, into scans: horizontal cuts, seen from the
/// origin of the cloud's frame.
class CloudCutter {
 public:
  /// Without a band, all points of a cloud have to be at one height, as a planar laser gives them.
  explicit CloudCutter(std::optional<HeightBand> band) : band_(band) {}

  /// Sets stamp, frame, readings and bearings. Within a band, the nearest of several points in one
  /// direction counts. A cloud without points there gives one reading that is no return. The
  /// spacing of the beams is taken from the first cloud that shows it. False if the cloud is not
  /// planar and there is no band; `fault` then says so.
  bool Cut(const RosCloud& cloud, RosScan* scan, std::string* fault);

 private:
  void KeepNearest(RosScan* scan) const;

  std::optional<HeightBand> band_;
  int num_beams_ = 0;  // all around; 0: not yet known
  double first_bearing_rad_ = 0.0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_CLOUD_CUTTER_H_
