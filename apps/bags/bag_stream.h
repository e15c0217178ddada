#ifndef PLUMBLINE_APPS_BAGS_BAG_STREAM_H_
#define PLUMBLINE_APPS_BAGS_BAG_STREAM_H_

#include <cstdint>
#include <functional>
#include <istream>
#include <optional>
#include <string>

#include "plumbline/core/status.h"

namespace plumbline {

/// Calls `read` with a seekable stream at its begin, and its size [bytes]: over the bytes of
/// `expanded` if it holds any, else over the file. Returns what `read` returns; NotFound or
/// InvalidArgument if the file cannot be opened.
Status ReadBagStream(const std::string& path, const std::optional<std::string>& expanded,
                     const std::function<Status(std::istream* stream, std::uint64_t size)>& read);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_BAG_STREAM_H_
