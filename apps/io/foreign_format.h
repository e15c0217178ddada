#ifndef PLUMBLINE_APPS_IO_FOREIGN_FORMAT_H_
#define PLUMBLINE_APPS_IO_FOREIGN_FORMAT_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// A format that robot teams have and no reader here takes.
struct ForeignFormat {
  std::string name;                      ///< with its article, e.g. "a point cloud (PCD)"
  std::vector<std::string_view> starts;  ///< bytes that only its files have at start_at
  std::vector<std::string> endings;      ///< of its files' names, e.g. ".pcd"; may be shared
  std::string advice;                    ///< how to get to something that is read
  std::size_t start_at = 0;
};

const std::vector<ForeignFormat>& ForeignFormats();

/// InvalidArgument, with name and advice, if a file begins as one of ForeignFormats does, also when
/// it is compressed by gzip. No log of CARMEN begins so.
Status RefuseForeignContent(const std::string& path);

/// The same by how the name ends, without ".gz". It proves nothing: for files that nothing could
/// be read from.
Status RefuseForeignName(const std::string& path);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_FOREIGN_FORMAT_H_
