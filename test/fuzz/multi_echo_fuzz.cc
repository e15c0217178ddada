#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "plumbline/apps/bags/ros_message.h"
#include "plumbline/test/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const RosEncoding encoding : {RosEncoding::kRos1, RosEncoding::kCdr}) {
    RosScan first, strongest;
    std::string fault, strongest_fault;
    const bool ok = DecodeMultiEchoScan(encoding, bytes, RosEcho::kFirst, &first, &fault);
    Require(ok == fault.empty());
    Require(first.ranges.size() <= size);
    const bool has_strongest =
        DecodeMultiEchoScan(encoding, bytes, RosEcho::kStrongest, &strongest, &strongest_fault);
    Require(has_strongest == strongest_fault.empty());
    Require(ok || !has_strongest);
    Require(!has_strongest || strongest.ranges.size() == first.ranges.size());
  }
  return 0;
}
