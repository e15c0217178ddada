#include "plumbline/apps/bags/bag_metadata.h"

#include <yaml-cpp/yaml.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"

namespace plumbline {
namespace {

// A few hundred topics with their settings take less than 1 MB; yaml-cpp takes up to 300 times
// that.
constexpr std::size_t kMaxBytes = std::size_t{1} << 21;

Status ReadText(const std::string& path, std::string* text) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return ReadError("open", path, errno);
  text->resize(kMaxBytes);
  file.read(text->data(), static_cast<std::streamsize>(text->size()));
  if (file.bad()) return ReadError("read", path, errno);
  if (file) return Status::InvalidArgument(path + ": too long for a description of a bag");
  text->resize(static_cast<std::size_t>(file.gcount()));
  return Status::Ok();
}

// Where a file of the bag is: beside the description. Early versions of rosbag2 put the name of the
// folder before that of a file.
std::string Locate(const std::filesystem::path& folder, const std::filesystem::path& file) {
  std::error_code ignored;
  const std::filesystem::path beside = folder / file.filename();
  const bool is_moved =
      !std::filesystem::exists(folder / file, ignored) && std::filesystem::exists(beside, ignored);
  return (is_moved ? beside : folder / file).string();
}

// Throws what yaml-cpp throws.
Status Parse(const std::string& path, const std::string& text, std::vector<std::string>* files) {
  const auto field = [&path](const std::string& name, const std::string& problem) {
    return Status::InvalidArgument(path + ": field '" + name + "': " + problem);
  };
  const YAML::Node root = YAML::Load(text);
  const std::string key(kBagMetadataKey);
  const YAML::Node bag = root.IsMap() ? root[key] : YAML::Node();
  if (!bag || !bag.IsMap()) return field(key, "is missing");
  const YAML::Node compression = bag["compression_format"];
  if (compression && compression.IsScalar() && !compression.Scalar().empty() &&
      compression.Scalar() != "zstd") {
    return field("compression_format",
                 Quote(compression.Scalar()) + " is none that can be read, only zstd is");
  }
  const YAML::Node paths = bag["relative_file_paths"];
  if (!paths || !paths.IsSequence() || paths.size() == 0) {
    return field("relative_file_paths", "it lists no files");
  }
  for (const YAML::Node& entry : paths) {
    if (!entry.IsScalar() || entry.Scalar().empty()) {
      return field("relative_file_paths", "an entry is no name of a file");
    }
    files->push_back(Locate(std::filesystem::path(path).parent_path(), entry.Scalar()));
  }
  return Status::Ok();
}

}  // namespace

Status ReadBagMetadata(const std::string& path, std::vector<std::string>* files) {
  std::string text;
  PLUMBLINE_RETURN_IF_ERROR(ReadText(path, &text));
  try {
    std::vector<std::string> result;
    PLUMBLINE_RETURN_IF_ERROR(Parse(path, text, &result));
    *files = std::move(result);
    return Status::Ok();
  } catch (const YAML::Exception& exception) {
    return Status::DataLoss(path + ": cannot be read as YAML: " + exception.what());
  }
}

}  // namespace plumbline
