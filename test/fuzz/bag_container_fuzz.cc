#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "plumbline/apps/bags/mcap_bag.h"
#include "plumbline/apps/bags/sqlite_bag.h"
#include "plumbline/test/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const bool is_database = bytes.compare(0, kSqliteMagic.size(), kSqliteMagic) == 0;
  const std::unique_ptr<BagContainer> bag =
      is_database ? MakeSqliteBag("a.db3", bytes) : MakeMcapBag("a.mcap", bytes);
  const auto count = [&bag](bool is_wanted, std::size_t* num_messages) {
    return bag->ReadMessages([is_wanted](const BagTopic&) { return is_wanted; },
                             [num_messages](const BagTopic&, double, std::string_view) {
                               ++*num_messages;
                               return Status::Ok();
                             });
  };
  std::size_t num_unwanted = 0, num_messages = 0, num_again = 0;
  const Status unwanted = count(false, &num_unwanted);
  const Status status = count(true, &num_messages);
  const Status again = count(true, &num_again);
  Require(num_unwanted == 0 && (unwanted.ok() || !status.ok()));
  Require(status.message() == again.message() && num_messages == num_again);
  return 0;
}
