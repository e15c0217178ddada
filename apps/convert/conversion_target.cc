#include "plumbline/apps/convert/conversion_target.h"

#include <cstddef>
#include <filesystem>
#include <sstream>

namespace plumbline {
namespace {

struct Naming {
  ConversionFormat format;
  const char* name;
  std::vector<std::string> extensions;
};

const std::vector<Naming>& Namings() {
  static const std::vector<Naming> namings = {
      {ConversionFormat::kTum, "tum", {".tum"}},
      {ConversionFormat::kG2o, "g2o", {".g2o"}},
      {ConversionFormat::kToro, "toro", {".toro", ".graph"}},
      {ConversionFormat::kPly, "ply", {".ply"}},
      {ConversionFormat::kPcd, "pcd", {".pcd"}},
      {ConversionFormat::kRosMap, "ros_map", {".pgm", ".yaml"}}};
  return namings;
}

const Naming& NamingOf(ConversionFormat format) {
  return Namings()[static_cast<std::size_t>(format)];
}

Status FormatOfExtension(const std::string& path, ConversionFormat* format) {
  const std::string extension = std::filesystem::path(path).extension().string();
  std::string known;
  for (const Naming& naming : Namings()) {
    for (const std::string& candidate : naming.extensions) {
      if (candidate == extension) {
        *format = naming.format;
        return Status::Ok();
      }
      known += ' ' + candidate;
    }
  }
  return Status::InvalidArgument("--output=" + path +
                                 ": the extension tells the format and should be one of" + known +
                                 "; or give --format");
}

// Poses without a scan to keep their time, other than the index that readers make up.
std::size_t NumTimesWithoutScan(const SlamGraph& graph) {
  std::vector<bool> kept(graph.num_poses(), false);
  for (int scan = 0; scan < graph.num_scans(); ++scan) kept[graph.scan(scan).pose] = true;
  std::size_t count = 0;
  for (int pose = 0; pose < graph.num_poses(); ++pose) {
    if (!kept[pose] && graph.timestamp_s(pose) != pose) ++count;
  }
  return count;
}

// Scans whose beams were measured one after the other.
std::size_t NumSweeps(const SlamGraph& graph) {
  std::size_t count = 0;
  for (int scan = 0; scan < graph.num_scans(); ++scan) {
    if (graph.LaserOfScan(scan).beam_period_s > 0.0) ++count;
  }
  return count;
}

}  // namespace

const char* ToString(ConversionFormat format) { return NamingOf(format).name; }

bool FromString(const std::string& name, ConversionFormat* format) {
  for (const Naming& naming : Namings()) {
    if (name != naming.name) continue;
    *format = naming.format;
    return true;
  }
  return false;
}

std::string ConversionTarget::MapStem() const {
  std::filesystem::path stem(path);
  for (const std::string& extension : NamingOf(ConversionFormat::kRosMap).extensions) {
    if (stem.extension() == extension) return stem.replace_extension().string();
  }
  return path;
}

std::vector<std::string> ConversionTarget::Files() const {
  if (format != ConversionFormat::kRosMap) return {path};
  return {MapStem() + ".pgm", MapStem() + ".yaml"};
}

bool ConversionTarget::NeedsReturns() const {
  return format == ConversionFormat::kPly || format == ConversionFormat::kPcd ||
         format == ConversionFormat::kRosMap;
}

Status ParseConversionTargets(const std::string& paths, const std::string& format,
                              std::vector<ConversionTarget>* targets) {
  std::vector<ConversionTarget> result;
  std::istringstream stream(paths + ',');
  for (std::string path; std::getline(stream, path, ',');) {
    if (path.empty()) return Status::InvalidArgument("--output=" + paths + ": an empty file name");
    result.push_back({path});
  }
  if (!format.empty()) {
    if (result.size() > 1) {
      return Status::InvalidArgument("--format goes with one output, and there are " +
                                     std::to_string(result.size()));
    }
    if (!FromString(format, &result[0].format)) {
      return Status::InvalidArgument("--format=" + format + ": no such format; see --help");
    }
  } else {
    for (ConversionTarget& target : result) {
      PLUMBLINE_RETURN_IF_ERROR(FormatOfExtension(target.path, &target.format));
    }
  }
  *targets = std::move(result);
  return Status::Ok();
}

std::string LeftOut(ConversionFormat format, const SlamGraph& graph) {
  std::string text;
  const auto add = [&text](std::size_t count, const std::string& name) {
    if (count == 0) return;
    text += (text.empty() ? "" : ", ") + std::to_string(count) + ' ' + name;
    if (count > 1) text += 's';
  };
  if (format == ConversionFormat::kG2o || format == ConversionFormat::kToro) {
    add(NumTimesWithoutScan(graph), "time");
    add(NumSweeps(graph), "sweep time");
    return text;
  }
  const bool is_tum = format == ConversionFormat::kTum;
  const bool is_points = format == ConversionFormat::kPly || format == ConversionFormat::kPcd;
  const std::vector<FixedPose>& fixed = graph.fixed_poses();
  if (!is_tum) add(graph.num_poses(), "pose");
  add(graph.odometry().size() + graph.relative_poses().size(), "edge");
  if (fixed.size() > 1 || (!fixed.empty() && fixed[0].pose != 0)) add(fixed.size(), "fixed pose");
  if (!is_points) add(graph.num_scans(), "scan");
  return text;
}

}  // namespace plumbline
