#ifndef PLUMBLINE_APPS_BAGS_BAG_STREAM_H_
#define PLUMBLINE_APPS_BAGS_BAG_STREAM_H_

#include <cstdint>
#include <functional>
#include <istream>
#include <optional>
#include <string>
#include <utility>

#include "plumbline/apps/bags/bag_container.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// A bag that is read from a seekable stream: over the bytes of `expanded` if it holds any, else
/// over the file. ReadMessages fails with NotFound or InvalidArgument if the file cannot be opened.
class StreamBag : public BagContainer {
 public:
  /// Does the work of ReadMessages and Omission on a stream at its begin; size: in bytes.
  using Walk = std::function<Status(const std::string& path, std::istream* stream,
                                    std::uint64_t size, const IsWanted& is_wanted,
                                    const TakeMessage& take, std::string* omission)>;

  StreamBag(std::string path, std::optional<std::string> expanded, Walk walk)
      : path_(std::move(path)), expanded_(std::move(expanded)), walk_(std::move(walk)) {}

  Status ReadMessages(const IsWanted& is_wanted, const TakeMessage& take) override;
  std::string Omission() const override { return omission_; }

 private:
  const std::string path_;
  const std::optional<std::string> expanded_;
  const Walk walk_;
  std::string omission_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_BAG_STREAM_H_
