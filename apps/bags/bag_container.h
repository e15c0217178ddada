#ifndef PLUMBLINE_APPS_BAGS_BAG_CONTAINER_H_
#define PLUMBLINE_APPS_BAGS_BAG_CONTAINER_H_

#include <functional>
#include <string>
#include <string_view>
#include <tuple>

#include "plumbline/core/status.h"

namespace plumbline {

/// A stream of messages of one type in a recording.
struct BagTopic {
  std::string name;      ///< "/scan"
  std::string type;      ///< as the recording has it: "sensor_msgs/LaserScan", "a_msgs/msg/B"
  std::string encoding;  ///< of the messages' bytes: "ros1", "cdr", ...

  friend bool operator<(const BagTopic& a, const BagTopic& b) {
    return std::tie(a.name, a.type, a.encoding) < std::tie(b.name, b.type, b.encoding);
  }
};

/// A recording of messages, whatever the format of its file.
class BagContainer {
 public:
  using IsWanted = std::function<bool(const BagTopic& topic)>;
  /// Time of arrival [s]; the bytes are there during the call only.
  using TakeMessage =
      std::function<Status(const BagTopic& topic, double time_s, std::string_view bytes)>;

  BagContainer() = default;
  BagContainer(const BagContainer&) = delete;
  BagContainer& operator=(const BagContainer&) = delete;
  virtual ~BagContainer() = default;

  /// Asks of each topic, at least once, whether it is wanted, and hands over the messages of those
  /// that are, in the order of the recording. Messages of others are neither copied nor kept. Stops
  /// at the first failure of `take`, which it returns. DataLoss, naming file and place, where the
  /// recording is damaged; InvalidArgument if it is none. May be called several times.
  virtual Status ReadMessages(const IsWanted& is_wanted, const TakeMessage& take) = 0;

  /// Part of the recording that the last ReadMessages had to leave out, as a clause for people;
  /// empty: none.
  virtual std::string Omission() const { return {}; }
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_BAG_CONTAINER_H_
