#include "plumbline/apps/program/output_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/file_status.h"

namespace plumbline {
namespace {

// All that a run over a log or a pose graph may write, in the order in which it is to go.
constexpr std::array<std::string_view, 26> kResults = {"summary.json",
                                                       "report.html",
                                                       "map_odometry.png",
                                                       "map_seed.png",
                                                       "map_given.png",
                                                       "map_refined.png",
                                                       "map_runner_up.png",
                                                       "map_refused.png",
                                                       "map_pose_graph.png",
                                                       "before_after.png",
                                                       "closures.png",
                                                       "conflicts.png",
                                                       "sessions.png",
                                                       "changes.png",
                                                       "map.yaml",
                                                       "map.pgm",
                                                       "map.g2o",
                                                       "points.ply",
                                                       "points.pcd",
                                                       "trajectory_seed.tum",
                                                       "trajectory.tum",
                                                       "graph.g2o",
                                                       "graph.toro",
                                                       "graph.pbstream",
                                                       "graph.posegraph",
                                                       "graph.data"};

// Whether it is `start`, a number, and `end`: as there may be any number of.
bool IsNumbered(std::string_view name, std::string_view start, std::string_view end) {
  if (name.size() <= start.size() + end.size() || name.substr(0, start.size()) != start ||
      name.substr(name.size() - end.size()) != end) {
    return false;
  }
  const std::string_view number =
      name.substr(start.size(), name.size() - start.size() - end.size());
  return number.find_first_not_of("0123456789") == std::string_view::npos;
}

bool IsTrajectoryOfSession(std::string_view name) {
  return IsNumbered(name, "trajectory_", ".tum");
}

bool IsResult(std::string_view name) {
  return std::find(kResults.begin(), kResults.end(), name) != kResults.end() ||
         IsTrajectoryOfSession(name);
}

std::string PathOf(const std::string& folder, std::string_view name) {
  return (std::filesystem::path(folder) / name).string();
}

std::string BaseName(const std::string& file) {
  return std::filesystem::path(file).filename().string();
}

// Of a path to a folder and the folders above it, those that are not there, the innermost first.
std::vector<std::string> MissingFolders(std::filesystem::path path) {
  std::vector<std::string> missing;
  std::error_code ignored;
  if (!path.has_filename()) path = path.parent_path();  // "out/"
  while (path.has_filename() && !std::filesystem::exists(path, ignored)) {
    missing.push_back(path.string());
    path = path.parent_path();
  }
  return missing;
}

// Results that are in a folder under names which are not known before.
struct FolderContent {
  std::vector<std::string> files;    ///< of sessions, and what killed runs have left half-written
  std::vector<std::string> of_maps;  ///< folders that MapFolder names
  std::error_code error;
};

FolderContent ContentOf(const std::string& folder) {
  FolderContent content;
  std::filesystem::directory_iterator entry(folder, content.error), end;
  while (!content.error && entry != end) {
    const std::filesystem::path file = entry->path();
    const std::string name = file.filename().string();
    std::error_code ignored;
    if (IsTrajectoryOfSession(name) || IsResult(TargetOfTemporary(name))) {
      content.files.push_back(file.string());
    } else if (IsNumbered(name, "map_", "") &&
               std::filesystem::is_directory(entry->symlink_status(ignored))) {
      content.of_maps.push_back(file.string());
    }
    entry.increment(content.error);
  }
  std::sort(content.files.begin(), content.files.end());
  std::sort(content.of_maps.begin(), content.of_maps.end());
  return content;
}

// What is kept elsewhere or nowhere, a device, is not there to be removed.
Status Remove(const std::string& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::symlink_status(file, error);
  if (!std::filesystem::exists(status) || std::filesystem::is_other(status)) return Status::Ok();
  if (std::filesystem::is_directory(status)) return WriteError("remove", file, EISDIR);
  std::filesystem::remove(file, error);
  return error ? WriteError("remove", file, error.value()) : Status::Ok();
}

}  // namespace

OutputFolder::OutputFolder(std::string path) : path_(std::move(path)) {}

OutputFolder::~OutputFolder() {
  if (descriptor_ >= 0) close(descriptor_);
}

Status OutputFolder::Make() {
  std::error_code error;
  made_folders_ = MissingFolders(path_);
  std::filesystem::create_directories(path_, error);
  if (error) {
    return Status::Unavailable("cannot make the folder '" + path_ + "': " + error.message());
  }
  PLUMBLINE_RETURN_IF_ERROR(Lock());
  return CheckWritable(File("summary.json"));
}

// The lock is the system's, on the open folder: no file to be left behind by a program that is
// killed.
Status OutputFolder::Lock() {
  if (descriptor_ >= 0) return Status::Ok();
  descriptor_ = open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor_ < 0 || flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) {
    return Status::Ok();
  }
  close(descriptor_);
  descriptor_ = -1;
  return Status::Unavailable("the folder '" + path_ + "' is in use: another run writes to it");
}

Status OutputFolder::RemoveOldResults() const {
  const FolderContent content = ContentOf(path_);
  if (content.error) {
    return Status::Unavailable("cannot read the folder '" + path_ +
                               "': " + content.error.message());
  }
  for (const std::string& file : ResultsIn(path_)) {
    const bool is_half_written = !TargetOfTemporary(BaseName(file)).empty();
    PLUMBLINE_RETURN_IF_ERROR(Remove(is_half_written ? file : FollowLinks(file)));
  }
  for (const std::string& folder : content.of_maps) {
    std::error_code has_other_files;
    std::filesystem::remove(folder, has_other_files);
  }
  return Status::Ok();
}

std::string OutputFolder::File(const std::string& name) const { return PathOf(path_, name); }

std::string OutputFolder::MapFolder(int number) const {
  return PathOf(path_, "map_" + std::to_string(number));
}

std::vector<std::string> ResultsIn(const std::string& folder) {
  std::vector<std::string> files;
  files.reserve(kResults.size());
  for (const std::string_view name : kResults) files.push_back(PathOf(folder, name));
  FolderContent content = ContentOf(folder);
  for (std::string& file : content.files) files.push_back(std::move(file));
  for (const std::string& of_map : content.of_maps) {
    for (std::string& file : ResultsIn(of_map)) files.push_back(std::move(file));
  }
  return files;
}

}  // namespace plumbline
