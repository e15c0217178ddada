#include "plumbline/apps/saved_maps/slam_toolbox_map.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "plumbline/apps/io/whole_file.h"
#include "plumbline/apps/saved_maps/karto_classes.h"

namespace plumbline {
namespace {

constexpr char kGraphExtension[] = ".posegraph";

bool HasGraphExtension(const std::string& path) {
  return std::filesystem::path(path).extension() == kGraphExtension;
}

// As a measure: what is kept of a file is its bytes, and less than as much again on the objects.
Status CheckSize(const std::string& path, double max_bytes) {
  constexpr double kBytesPerMb = 1e6;
  double bytes = 0.0;
  for (const std::string& file : SlamToolboxFiles(path)) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error) bytes += 2.0 * static_cast<double>(size);
  }
  if (max_bytes == 0.0 || bytes <= max_bytes) return Status::Ok();
  return Status::InvalidArgument(
      path + ": with the file of the lasers it takes more memory than the " +
      std::to_string(static_cast<long long>(max_bytes / kBytesPerMb)) + " MB allowed");
}

Status ReadArchive(const std::string& path, const char* root_class, BoostArchive* archive) {
  std::string bytes;
  PLUMBLINE_RETURN_IF_ERROR(ReadWholeFile(path, &bytes));
  const Status status = archive->Read(std::move(bytes), KartoClasses(), root_class);
  if (status.ok()) return Status::Ok();
  const std::string message =
      path + ": cannot be read as a map of slam_toolbox: " + status.message();
  return status.code() == StatusCode::kDataLoss ? Status::DataLoss(message)
                                                : Status::InvalidArgument(message);
}

// Of a map<int32, T*>: what its pointers lead to, without null pointers.
std::vector<ArchiveObject> ValuesOf(const ArchiveObject& map) {
  std::vector<ArchiveObject> values;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const ArchiveObject value = map[i].Object("second");
    if (!value.is_null()) values.push_back(value);
  }
  return values;
}

// Of the class that the scan's ids and time belong to.
ArchiveObject SensorDataOf(const ArchiveObject& scan) { return scan.Object("base").Object("base"); }

}  // namespace

bool IsSlamToolboxMap(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return HasGraphExtension(path);
  std::string start(64, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return BoostArchive::IsArchive(start) || HasGraphExtension(path);
}

std::vector<std::string> SlamToolboxFiles(const std::string& path) {
  return {path, std::filesystem::path(path).replace_extension(".data").string()};
}

Status ReadSlamToolboxMap(const std::string& path, double max_bytes, SlamToolboxMap* map) {
  if (!HasGraphExtension(path)) {
    return Status::InvalidArgument(path +
                                   ": of the two files of a map of slam_toolbox, name the one that "
                                   "ends in " +
                                   kGraphExtension);
  }
  const std::string data_path = SlamToolboxFiles(path)[1];
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored) && !std::filesystem::exists(data_path, ignored)) {
    return Status::NotFound(path + ": there is no '" + data_path +
                            "', where slam_toolbox saves the lasers of this map");
  }
  PLUMBLINE_RETURN_IF_ERROR(CheckSize(path, max_bytes));
  SlamToolboxMap result;
  result.path = path;
  PLUMBLINE_RETURN_IF_ERROR(ReadArchive(path, "karto::Mapper", &result.mapper));
  PLUMBLINE_RETURN_IF_ERROR(ReadArchive(data_path, "karto::Dataset", &result.dataset));
  *map = std::move(result);
  return Status::Ok();
}

std::vector<ArchiveObject> GraphScansOf(const SlamToolboxMap& map) {
  std::vector<ArchiveObject> scans;
  const ArchiveObject graph = map.mapper.root().Object("graph");
  if (graph.is_null()) return scans;
  const ArchiveObject vertices = graph.Object("base").Object("vertices");
  for (std::size_t sensor = 0; sensor < vertices.size(); ++sensor) {
    for (const ArchiveObject& vertex : ValuesOf(vertices[sensor].Object("second"))) {
      const ArchiveObject scan = vertex.Object("object");
      if (!scan.is_null()) scans.push_back(scan);
    }
  }
  std::stable_sort(scans.begin(), scans.end(), [](const ArchiveObject& a, const ArchiveObject& b) {
    return ScanId(a) < ScanId(b);
  });
  return scans;
}

std::vector<ArchiveObject> GraphEdgesOf(const SlamToolboxMap& map) {
  std::vector<ArchiveObject> result;
  const ArchiveObject graph = map.mapper.root().Object("graph");
  if (graph.is_null()) return result;
  const ArchiveObject edges = graph.Object("base").Object("edges");
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (!edges[i].is_null()) result.push_back(edges[i]);
  }
  return result;
}

std::vector<ArchiveObject> DatasetScansOf(const SlamToolboxMap& map) {
  std::vector<ArchiveObject> scans = ValuesOf(map.dataset.root().Object("data"));
  scans.erase(std::remove_if(scans.begin(), scans.end(),
                             [](const ArchiveObject& object) {
                               return !object.IsA("karto::LocalizedRangeScan");
                             }),
              scans.end());
  return scans;
}

int ScanId(const ArchiveObject& scan) {
  return static_cast<int>(SensorDataOf(scan).Number("unique_id"));
}

Pose2 PoseOf(const ArchiveObject& pose) {
  const ArchiveObject position = pose.Object("position");
  return {position.Number("x"), position.Number("y"), pose.Number("heading")};
}

}  // namespace plumbline
