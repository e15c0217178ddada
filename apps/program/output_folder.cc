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
constexpr std::array<std::string_view, 23> kResults = {"summary.json",
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
                                                       "map.yaml",
                                                       "map.pgm",
                                                       "points.ply",
                                                       "points.pcd",
                                                       "trajectory_seed.tum",
                                                       "trajectory.tum",
                                                       "graph.g2o",
                                                       "graph.toro",
                                                       "graph.pbstream",
                                                       "graph.posegraph",
                                                       "graph.data"};

bool IsResult(std::string_view name) {
  return std::find(kResults.begin(), kResults.end(), name) != kResults.end();
}

std::string PathOf(const std::string& folder, std::string_view name) {
  return (std::filesystem::path(folder) / name).string();
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

// What killed runs have left half-written.
std::vector<std::string> LeftoversIn(const std::string& folder, std::error_code* error) {
  std::vector<std::string> files;
  std::filesystem::directory_iterator entry(folder, *error), end;
  while (!*error && entry != end) {
    const std::filesystem::path file = entry->path();
    if (IsResult(TargetOfTemporary(file.filename().string()))) files.push_back(file.string());
    entry.increment(*error);
  }
  return files;
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
  for (const std::string_view name : kResults) {
    PLUMBLINE_RETURN_IF_ERROR(Remove(FollowLinks(PathOf(path_, name))));
  }
  std::error_code error;
  for (const std::string& file : LeftoversIn(path_, &error)) {
    PLUMBLINE_RETURN_IF_ERROR(Remove(file));
  }
  if (!error) return Status::Ok();
  return Status::Unavailable("cannot read the folder '" + path_ + "': " + error.message());
}

std::string OutputFolder::File(const std::string& name) const { return PathOf(path_, name); }

std::vector<std::string> ResultsIn(const std::string& folder) {
  std::vector<std::string> files;
  files.reserve(kResults.size());
  for (const std::string_view name : kResults) files.push_back(PathOf(folder, name));
  std::error_code ignored;
  for (std::string& file : LeftoversIn(folder, &ignored)) files.push_back(std::move(file));
  return files;
}

}  // namespace plumbline
