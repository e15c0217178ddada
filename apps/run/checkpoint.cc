#include "plumbline/apps/run/checkpoint.h"

#include <sys/stat.h>
#include <zlib.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "plumbline/apps/bags/open_bag.h"
#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/apps/io/binary_archive.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/little_endian.h"
#include "plumbline/apps/program/command_line.h"

namespace plumbline {

// What the structs are made of. Structured bindings do not compile if a field is missing here.

template <typename Archive>
void Visit(Archive& archive, Pose2* pose) {
  auto& [x, y, yaw] = *pose;
  archive(x, y, yaw);
}

template <typename Archive>
void Visit(Archive& archive, OdometrySignReport* report) {
  auto& [num_backward_steps, num_decided, num_contradicting, sign_lost] = *report;
  archive(num_backward_steps, num_decided, num_contradicting, sign_lost);
}

template <typename Archive>
void Visit(Archive& archive, SequentialSeedingReport* report) {
  auto& [odometry_sign, num_keyframes, num_reversed_steps, num_recovered, num_unmatched] = *report;
  archive(odometry_sign, num_keyframes, num_reversed_steps, num_recovered, num_unmatched);
}

template <typename Archive>
void Visit(Archive& archive, ClockOffset* offset) {
  auto& [value_s, sigma_s] = *offset;
  archive(value_s, sigma_s);
}

template <typename Archive>
void Visit(Archive& archive, SystematicError* error) {
  auto& [value, sigma] = *error;
  archive(value, sigma);
}

template <typename Archive>
void Visit(Archive& archive, RandomError* error) {
  auto& [estimated, num_spans, sigma_per_sqrt_m, sigma_per_sqrt_rad] = *error;
  archive(estimated, num_spans, sigma_per_sqrt_m, sigma_per_sqrt_rad);
}

template <typename Archive>
void Visit(Archive& archive, MotionOptions* motion) {
  auto& [alpha_1, alpha_2, alpha_3, alpha_4, translation_floor, rotation_floor] = *motion;
  archive(alpha_1, alpha_2, alpha_3, alpha_4, translation_floor, rotation_floor);
}

template <typename Archive>
void Visit(Archive& archive, OdometryNoiseReport* report) {
  auto& [gross_scale, clock_offset, translation_scale, rotation_scale, drift, translation, rotation,
         leaps, still_steps, motion, is_prediction, given_poses] = *report;
  archive(gross_scale, clock_offset, translation_scale, rotation_scale, drift, translation,
          rotation, leaps, still_steps, motion, is_prediction, given_poses.position_m,
          given_poses.yaw_rad);
}

template <typename Archive>
void Visit(Archive& archive, LoopClosureRecord* record) {
  auto& [from_pose, to_pose, from_from_to, outcome] = *record;
  archive(from_pose, to_pose, from_from_to, outcome);
}

template <typename Archive>
void Visit(Archive& archive, SuspectStep* step) {
  auto& [first_pose_after, evidence, broken, unmatched, turned_rad, num_closures_across,
         num_alternatives] = *step;
  archive(first_pose_after, evidence, broken, unmatched, turned_rad, num_closures_across,
          num_alternatives);
}

template <typename Archive>
void Visit(Archive& archive, LoopClosingReport* report) {
  auto& [num_candidates, num_closures, num_contradicted, matches, suspect_steps] = *report;
  archive(num_candidates, num_closures, num_contradicted, matches, suspect_steps);
}

template <typename Archive>
void Visit(Archive& archive, FreeSpaceConflict* conflict) {
  auto& [num_compared, num_conflicting] = *conflict;
  archive(num_compared, num_conflicting);
}

template <typename Archive>
void Visit(Archive& archive, ConflictPeak* peak) {
  auto& [conflict, pose, usual_ratio] = *peak;
  archive(conflict, pose, usual_ratio);
}

template <typename Archive>
void Visit(Archive& archive, SpaceConflict* place) {
  auto& [viewer_scan, scan, world_point] = *place;
  archive(viewer_scan, scan, world_point.x(), world_point.y());
}

template <typename Archive>
void Visit(Archive& archive, ViewpointConflict* viewpoint) {
  auto& [pose, within, between] = *viewpoint;
  archive(pose, within, between);
}

template <typename Archive>
void Visit(Archive& archive, MapConsistency* map) {
  auto& [within, between, pairs_within, pairs_between, worst_within, worst_between,
         contradicted_share, usual_ratio_at_rest, viewpoints, places] = *map;
  archive(within, between, pairs_within, pairs_between, worst_within, worst_between,
          contradicted_share, usual_ratio_at_rest, viewpoints, places);
}

template <typename Archive>
void Visit(Archive& archive, WeighedHypothesis* hypothesis) {
  auto& [kind, first_later, last_later, first_earlier, last_earlier, num_closures, carried_to,
         first_pose_after, conflict, score, adopted, world_from_robot] = *hypothesis;
  archive(kind, first_later, last_later, first_earlier, last_earlier, num_closures, carried_to,
          first_pose_after, conflict, score, adopted, world_from_robot);
}

template <typename Archive>
void Visit(Archive& archive, RelativePoseConstraint* edge) {
  auto& [from, to, from_from_to, covariance] = *edge;
  archive(from, to, from_from_to);
  for (Eigen::Index i = 0; i < covariance.size(); ++i) archive(covariance.data()[i]);
}

template <typename Archive>
void Visit(Archive& archive, MeasurementCorrections* corrections) {
  auto& [odometry, robot_from_laser, range_m, bearing_rad, moving_returns] = *corrections;
  archive(odometry, robot_from_laser, range_m, bearing_rad, moving_returns);
}

template <typename Archive>
void Visit(Archive& archive, SeedingReport* report) {
  auto& [start, sequential, moving_share, odometry_noise, loops, consistency, hypotheses,
         pose_graph, corrections, poses, alarm] = *report;
  archive(start, sequential, moving_share, odometry_noise, loops, consistency, hypotheses,
          pose_graph, corrections, poses, alarm);
}

template <typename Archive>
void Visit(Archive& archive, RunFingerprint::value_type* entry) {
  archive(entry->first, entry->second);
}

namespace {

// The file: these words and the version, a line; what Contents holds; the CRC-32 of all that.
constexpr std::string_view kMagic = "Plumbline checkpoint ";
constexpr std::string_view kHeading = "Plumbline checkpoint 12\n";
constexpr std::size_t kCrcSize = sizeof(std::uint32_t);

constexpr std::array<std::string_view, 10> kFlagsWithoutEffect = {
    "log",     "output_dir",      "checkpoint",       "resume", "max_memory",
    "threads", "picture_side_px", "map_resolution_m", "truth",  "hits"};

struct Contents {
  RunFingerprint fingerprint;
  std::vector<double> poses;  // as MapState::poses
  SeedingReport seeding;
};

template <typename Archive>
void Visit(Archive& archive, Contents* contents) {
  auto& [fingerprint, poses, seeding] = *contents;
  archive(fingerprint, poses, seeding);
}

std::uint32_t Crc(std::string_view bytes, std::uint32_t before = 0) {
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

Status OpenFile(const std::string& path, std::ifstream* file) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return ReadError("read", path, EISDIR);
  errno = 0;
  file->open(path, std::ios::binary);
  return *file ? Status::Ok() : ReadError("open", path, errno);
}

Status ReadBytes(const std::string& path, std::string* bytes) {
  std::ifstream file;
  PLUMBLINE_RETURN_IF_ERROR(OpenFile(path, &file));
  // What does not begin like a checkpoint is not taken into memory.
  bytes->resize(kMagic.size());
  file.read(bytes->data(), static_cast<std::streamsize>(bytes->size()));
  bytes->resize(static_cast<std::size_t>(file.gcount()));
  if (*bytes != kMagic) return Status::Ok();
  bytes->append(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  return Status::Ok();
}

// Adds a file of any size to the size and the checksum of those before it.
Status AddFile(const std::string& path, std::uintmax_t* size, std::uint32_t* crc) {
  std::ifstream file;
  PLUMBLINE_RETURN_IF_ERROR(OpenFile(path, &file));
  std::string block(std::size_t{1} << 18, '\0');
  while (file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto num_read = static_cast<std::size_t>(file.gcount());
    *size += num_read;
    *crc = Crc(std::string_view(block.data(), num_read), *crc);
  }
  return file.bad() ? ReadError("read", path, errno) : Status::Ok();
}

// The files that a log is read from, with what SQLite keeps beside them.
Status FilesToRead(const std::string& log, std::vector<std::string>* files) {
  PLUMBLINE_RETURN_IF_ERROR(FilesOfLog(log, files));
  std::error_code ignored;
  for (std::size_t i = 0, num_files = files->size(); i < num_files; ++i) {
    const std::string wal = (*files)[i] + "-wal";
    if (std::filesystem::exists(wal, ignored)) files->push_back(wal);
  }
  return Status::Ok();
}

Status StampOf(const std::string& log, LogStamp* stamp) {
  std::vector<std::string> files;
  PLUMBLINE_RETURN_IF_ERROR(FilesToRead(log, &files));
  std::ostringstream text;
  for (const std::string& file : files) {
    struct stat status {};
    if (stat(file.c_str(), &status) != 0) return ReadError("open", file, errno);
    text << file << ' ' << status.st_dev << ' ' << status.st_ino << ' ' << status.st_size;
    for (const timespec& time : {status.st_mtim, status.st_ctim}) {
      text << ' ' << time.tv_sec << '.' << time.tv_nsec;
    }
    text << '\n';
  }
  *stamp = text.str();
  return Status::Ok();
}

// Size and checksum of a log, into the fingerprint.
Status AddContent(const std::string& log, RunFingerprint* fingerprint) {
  std::vector<std::string> files;
  PLUMBLINE_RETURN_IF_ERROR(FilesToRead(log, &files));
  std::uintmax_t size = 0;
  std::uint32_t crc = Crc("");
  for (const std::string& file : files) PLUMBLINE_RETURN_IF_ERROR(AddFile(file, &size, &crc));
  fingerprint->emplace_back("the size of the log [bytes]", std::to_string(size));
  fingerprint->emplace_back("the checksum of the log", std::to_string(crc));
  return Status::Ok();
}

// Two values of one quantity, for people.
std::string Difference(const std::string& name, const std::string& in_file,
                       const std::string& here) {
  const auto shown = [](const std::string& value) { return value.empty() ? "nothing" : value; };
  return name + " was " + shown(in_file) + ", here it is " + shown(here);
}

Status Compare(const std::string& path, const RunFingerprint& in_file, const RunFingerprint& here) {
  const auto value_in = [](const RunFingerprint& fingerprint, const std::string& name) {
    const auto entry = std::find_if(fingerprint.begin(), fingerprint.end(),
                                    [&](const auto& pair) { return pair.first == name; });
    return entry == fingerprint.end() ? std::string() : entry->second;
  };
  for (const auto& [name, value] : here) {
    const std::string was = value_in(in_file, name);
    if (was == value) continue;
    return Status::InvalidArgument(
        path + " is the checkpoint of another run: " + Difference(name, was, value));
  }
  for (const auto& [name, value] : in_file) {
    if (value.empty() || value_in(here, name) == value) continue;
    return Status::InvalidArgument(
        path + " is the checkpoint of another run: " + Difference(name, value, ""));
  }
  return Status::Ok();
}

Status Parse(const std::string& path, std::string_view bytes, Contents* contents) {
  if (bytes.substr(0, kMagic.size()) != kMagic.substr(0, bytes.size()) || bytes.empty()) {
    return Status::InvalidArgument(path + " is no checkpoint of this program");
  }
  Status damaged = Status::DataLoss(path + ": the checkpoint is damaged or cut off");
  if (bytes.size() < kHeading.size() + kCrcSize) return damaged;
  if (bytes.substr(0, kHeading.size()) != kHeading) {
    return Status::InvalidArgument(path + " is a checkpoint of another version");
  }
  const std::string_view body = bytes.substr(0, bytes.size() - kCrcSize);
  if (LoadLittleEndian<std::uint32_t>(&bytes[body.size()]) != Crc(body)) return damaged;
  BinaryReader reader(body.substr(kHeading.size()));
  reader(*contents);
  return reader.ok() && reader.at_end() ? Status::Ok() : damaged;
}

// Whether the contents can be put into a graph of this size.
Status CheckContents(const std::string& path, const Contents& contents, const SlamGraph& graph) {
  const auto check = [&](const char* field, std::size_t size, std::size_t expected) {
    if (size == expected) return Status::Ok();
    return Status::InvalidArgument(path + ": " + field + " has " + std::to_string(size) +
                                   " entries, but the log needs " + std::to_string(expected));
  };
  const auto num_poses = static_cast<std::size_t>(graph.num_poses());
  PLUMBLINE_RETURN_IF_ERROR(check("field 'poses'", contents.poses.size(), 3 * num_poses));
  PLUMBLINE_RETURN_IF_ERROR(check("field 'seeding.corrections.odometry'",
                                  contents.seeding.corrections.odometry.size(),
                                  graph.odometry().size()));
  PLUMBLINE_RETURN_IF_ERROR(check("field 'seeding.sequential_poses'",
                                  contents.seeding.sequential_poses.size(), num_poses));
  for (const std::size_t id : contents.seeding.corrections.moving_returns) {
    if (id >= graph.num_returns_of_all()) {
      return Status::InvalidArgument(path + ": field 'seeding.corrections.moving_returns' has " +
                                     std::to_string(id) + ", but the log has " +
                                     std::to_string(graph.num_returns_of_all()) + " returns");
    }
  }
  for (const WeighedHypothesis& hypothesis : contents.seeding.hypotheses) {
    if (hypothesis.world_from_robot.empty()) continue;
    PLUMBLINE_RETURN_IF_ERROR(check("field 'seeding.hypotheses.world_from_robot'",
                                    hypothesis.world_from_robot.size(), num_poses));
  }
  const bool finite = std::all_of(contents.poses.begin(), contents.poses.end(),
                                  [](double value) { return std::isfinite(value); });
  return finite ? Status::Ok()
                : Status::InvalidArgument(path + ": field 'poses' holds what is not finite");
}

}  // namespace

Status FingerprintOfRun(const std::string& log, RunFingerprint* fingerprint, LogStamp* stamp) {
  RunFingerprint result;
  LogStamp before;
  PLUMBLINE_RETURN_IF_ERROR(StampOf(log, &before));
  PLUMBLINE_RETURN_IF_ERROR(AddContent(log, &result));
  for (const gflags::CommandLineFlagInfo& flag : ProgramFlags()) {
    const auto end = kFlagsWithoutEffect.end();
    if (std::find(kFlagsWithoutEffect.begin(), end, flag.name) != end) continue;
    result.emplace_back("--" + flag.name, flag.current_value);
  }
  *fingerprint = std::move(result);
  *stamp = std::move(before);
  return Status::Ok();
}

Status CheckUnchanged(const std::string& log, const LogStamp& stamp) {
  LogStamp now;
  PLUMBLINE_RETURN_IF_ERROR(StampOf(log, &now));
  if (now == stamp) return Status::Ok();
  return Status::InvalidArgument(log + ": the log changed while it was read");
}

Status WriteCheckpoint(const std::string& path, const RunFingerprint& fingerprint,
                       const std::vector<double>& poses, const SeedingReport& seeding) {
  Contents contents{fingerprint, poses, seeding};
  BinaryWriter writer;
  writer(contents);
  std::array<unsigned char, kCrcSize> crc;
  StoreLittleEndian(Crc(writer.bytes(), Crc(kHeading)), crc.data());
  RemoveAbandonedTemporaries(path);
  AtomicFile file;
  PLUMBLINE_RETURN_IF_ERROR(file.Open(path));
  file.stream() << kHeading << writer.bytes();
  file.stream().write(reinterpret_cast<const char*>(crc.data()), crc.size());
  return file.Commit();
}

std::string PackSeed(const std::vector<double>& poses, const SeedingReport& seeding) {
  Contents contents{{}, poses, seeding};
  BinaryWriter writer;
  writer(contents);
  return writer.bytes();
}

void UnpackSeed(const std::string& bytes, std::vector<double>* poses, SeedingReport* seeding) {
  Contents contents;
  BinaryReader reader(bytes);
  reader(contents);
  *poses = std::move(contents.poses);
  *seeding = std::move(contents.seeding);
}

Status ReadCheckpoint(const std::string& path, const RunFingerprint& fingerprint,
                      const SlamGraph& graph, std::vector<double>* poses, SeedingReport* seeding) {
  std::string bytes;
  PLUMBLINE_RETURN_IF_ERROR(ReadBytes(path, &bytes));
  Contents contents;
  PLUMBLINE_RETURN_IF_ERROR(Parse(path, bytes, &contents));
  PLUMBLINE_RETURN_IF_ERROR(Compare(path, contents.fingerprint, fingerprint));
  PLUMBLINE_RETURN_IF_ERROR(CheckContents(path, contents, graph));
  *poses = std::move(contents.poses);
  *seeding = std::move(contents.seeding);
  return Status::Ok();
}

}  // namespace plumbline
