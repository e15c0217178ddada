#ifndef PLUMBLINE_APPS_BAGS_BAG_METADATA_H_
#define PLUMBLINE_APPS_BAGS_BAG_METADATA_H_

#include <string>
#include <string_view>
#include <vector>

#include "plumbline/core/status.h"

namespace plumbline {

/// Name of the file that describes a bag of ROS 2 in a folder, and what it has first.
constexpr std::string_view kBagMetadataName = "metadata.yaml";
constexpr std::string_view kBagMetadataKey = "rosbag2_bagfile_information";

/// Reads the paths of the files that a bag of ROS 2 is split into from its metadata.yaml, in the
/// order of the recording. DataLoss if it is no YAML; InvalidArgument, naming the field, if it
/// lists no files, or says that they are compressed by another format than zstd; NotFound or
/// InvalidArgument if it cannot be read. Whether the files are there is not looked at.
Status ReadBagMetadata(const std::string& path, std::vector<std::string>* files);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BAGS_BAG_METADATA_H_
