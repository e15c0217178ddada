#include "plumbline/apps/program/output_folder.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "plumbline/apps/io/atomic_file.h"

namespace plumbline {
namespace {

// All that a run over a log or a pose graph may write, in the order in which it is to go.
constexpr std::array<std::string_view, 20> kResults = {"summary.json",
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
                                                       "graph.toro"};

bool IsResult(std::string_view name) {
  return std::find(kResults.begin(), kResults.end(), name) != kResults.end();
}

bool IsOneOf(const std::filesystem::path& file, const std::vector<std::string>& inputs) {
  return std::any_of(inputs.begin(), inputs.end(), [&](const std::string& input) {
    std::error_code ignored;
    return std::filesystem::equivalent(file, input, ignored);
  });
}

Status Remove(const std::filesystem::path& file) {
  std::error_code error;
  std::filesystem::remove(file, error);
  if (!error) return Status::Ok();
  return Status::Unavailable("cannot remove '" + file.string() + "': " + error.message());
}

}  // namespace

OutputFolder::OutputFolder(std::string path) : path_(std::move(path)) {}

Status OutputFolder::Make() const {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  if (error) {
    return Status::Unavailable("cannot make the folder '" + path_ + "': " + error.message());
  }
  return AtomicFile().Open(File("summary.json"));
}

Status OutputFolder::RemoveOldResults(const std::vector<std::string>& inputs) const {
  for (const std::string_view name : kResults) {
    const std::string file = File(std::string(name));
    if (!IsOneOf(file, inputs)) PLUMBLINE_RETURN_IF_ERROR(Remove(file));
  }
  std::error_code error;
  std::filesystem::directory_iterator entry(path_, error), end;
  while (!error && entry != end) {
    const std::filesystem::path file = entry->path();
    entry.increment(error);
    if (!IsResult(TargetOfTemporary(file.filename().string()))) continue;
    PLUMBLINE_RETURN_IF_ERROR(Remove(file));
  }
  if (!error) return Status::Ok();
  return Status::Unavailable("cannot read the folder '" + path_ + "': " + error.message());
}

std::string OutputFolder::File(const std::string& name) const {
  return (std::filesystem::path(path_) / name).string();
}

}  // namespace plumbline
