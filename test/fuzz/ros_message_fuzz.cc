#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/test/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const RosEncoding encoding : {RosEncoding::kRos1, RosEncoding::kCdr}) {
    RosScan scan;
    RosOdometry odometry;
    std::vector<RosTransform> transforms;
    std::string fault;
    Require(DecodeScan(encoding, bytes, &scan, &fault) == fault.empty());
    Require(scan.ranges.size() <= size);
    fault.clear();
    Require(DecodeOdometry(encoding, bytes, &odometry, &fault) == fault.empty());
    fault.clear();
    Require(DecodeTransforms(encoding, bytes, &transforms, &fault) == fault.empty());
    Require(transforms.size() <= size);
  }
  return 0;
}
