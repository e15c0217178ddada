#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "plumbline/apps/bags/cloud_cutter.h"
#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/test/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const RosEncoding encoding : {RosEncoding::kRos1, RosEncoding::kCdr}) {
    RosCloud cloud;
    std::string fault;
    const bool ok = DecodeCloud(encoding, bytes, &cloud, &fault);
    Require(ok == fault.empty());
    Require(cloud.points.size() <= size);
    if (!ok) continue;
    for (const std::optional<HeightBand> band : {std::optional<HeightBand>(), {{-1.0, 1.0}}}) {
      CloudCutter cutter(band);
      RosScan scan;
      if (!cutter.Cut(cloud, &scan, &fault)) {
        Require(!band && !fault.empty());
        continue;
      }
      Require(!scan.ranges.empty() && scan.ranges.size() == scan.bearings_rad.size());
      Require(scan.ranges.size() <= cloud.points.size() + 1);
      Require(std::isfinite(scan.angle_min_rad) && scan.angle_increment_rad > 0.0);
      for (const double bearing_rad : scan.bearings_rad) Require(std::abs(bearing_rad) < 7.0);
    }
  }
  return 0;
}
