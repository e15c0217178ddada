#ifndef PLUMBLINE_TEST_FUZZ_CONTAINER_CHECK_H_
#define PLUMBLINE_TEST_FUZZ_CONTAINER_CHECK_H_

#include <cstddef>
#include <string_view>

#include "plumbline/apps/bags/bag_container.h"
#include "plumbline/test/fuzz/input_file.h"

namespace plumbline {

/// Reads a container three times: unwanted messages are not handed over, and a second reading gives
/// the same number of messages and the same error as the first.
inline void CheckContainer(BagContainer* bag) {
  const auto count = [bag](bool is_wanted, std::size_t* num_messages) {
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
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_FUZZ_CONTAINER_CHECK_H_
