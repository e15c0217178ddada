#include <cstddef>
#include <cstdint>
#include <string>

#include "plumbline/apps/bags/ros1_bag.h"
#include "plumbline/test/fuzz/container_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  CheckContainer(
      MakeRos1Bag("a.bag", std::string(reinterpret_cast<const char*>(data), size)).get());
  return 0;
}
