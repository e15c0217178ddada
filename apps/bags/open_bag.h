#ifndef PLUMBLINE_APPS_BAGS_OPEN_BAG_H_
#define PLUMBLINE_APPS_BAGS_OPEN_BAG_H_

#include <memory>
#include <string>
#include <vector>

#include "plumbline/apps/bags/bag_container.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// Whether a path leads to what only OpenBag may be able to read: a folder, or a file whose first
/// bytes are those of a bag, of its description (metadata.yaml), or of what zstd compresses.
bool IsBag(const std::string& path);

/// Opens a bag, told by its content: a file of ROS 1, SQLite or MCAP, each also compressed as a
/// whole by zstd, which takes the memory that it expands to, at most 1 GiB and max_bytes (0: no
/// limit of the caller's own); or a folder of ROS 2 with a metadata.yaml, given itself or by that
/// file, whose files come one after the other. If there is no bag, NotFound, or
/// InvalidArgument with the kind of file that is there; DataLoss like the containers.
Status OpenBag(const std::string& path, std::unique_ptr<BagContainer>* bag, double max_bytes = 0.0);

/// The files that a log is made of: of a folder with a bag, or of its metadata.yaml, this and the
/// files that it lists; of any other path, this. Fails like OpenBag.
Status FilesOfLog(const std::string& path, std::vector<std::string>* files);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_OPEN_BAG_H_
