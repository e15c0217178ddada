#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "plumbline/apps/bags/mcap_bag.h"
#include "plumbline/apps/bags/sqlite_bag.h"
#include "plumbline/test/fuzz/container_check.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const bool is_database = bytes.compare(0, kSqliteMagic.size(), kSqliteMagic) == 0;
  const std::unique_ptr<BagContainer> bag =
      is_database ? MakeSqliteBag("a.db3", bytes) : MakeMcapBag("a.mcap", bytes);
  CheckContainer(bag.get());
  return 0;
}
