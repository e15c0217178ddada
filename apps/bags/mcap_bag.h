#ifndef PLUMBLINE_APPS_BAGS_MCAP_BAG_H_
#define PLUMBLINE_APPS_BAGS_MCAP_BAG_H_

#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "plumbline/apps/bags/bag_container.h"

namespace plumbline {

/// How MCAP files begin and end. The fifth byte is the version.
constexpr std::string_view kMcapMagic("\x89MCAP0\r\n", 8);

/// An MCAP file (mcap.dev, specification of version 0): with chunks, plain, LZ4 or zstd, or
/// without. The records are read from the first to the last; an index is not needed, and checksums
/// are checked where they are given. Memory is bounded by the longest chunk, which may have 1 GiB.
/// Without `expanded` the file is read; otherwise it is compressed as a whole and this is what it
/// holds. ReadMessages fails with DataLoss, naming the byte, where the file is damaged or cut off.
std::unique_ptr<BagContainer> MakeMcapBag(std::string path, std::optional<std::string> expanded);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_MCAP_BAG_H_
