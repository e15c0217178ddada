#include "plumbline/apps/io/pose_graph_file.h"

#include <Eigen/LU>
#include <algorithm>
#include <charconv>
#include <filesystem>
#include <numeric>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/io/memory_limit.h"
#include "plumbline/apps/io/pose_graph_records.h"
#include "plumbline/apps/io/text_reader.h"
#include "plumbline/core/rotate_axes.h"
#include "plumbline/solvers/pose_graph/connected_poses.h"

namespace plumbline {
namespace {

constexpr char kLaser[] = "ROBOTLASER1";

bool StartsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

bool HasPoseGraphExtension(const std::string& path) {
  std::filesystem::path name(path);
  if (name.extension() == ".gz") name = name.stem();
  for (const PoseGraphFormat format : {PoseGraphFormat::kG2o, PoseGraphFormat::kToro}) {
    if (name.extension() == std::string(".") + ToString(format)) return true;
  }
  return false;
}

long long ReadId(FieldReader* fields, const char* field) {
  const std::string_view word = fields->Word(field);
  long long id = 0;
  const char* end = word.data() + word.size();
  const std::from_chars_result result = std::from_chars(word.data(), end, id);
  if (result.ec != std::errc() || result.ptr != end) {
    fields->Fail(field, Quote(word) + " is not an integer");
  }
  return id;
}

bool Contains(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

// Names records of other programs by a part of their keyword, and says how to do without them.
std::string UnknownRecordText(std::string_view keyword) {
  constexpr struct {
    std::string_view part;
    const char* text;
  } kRecords[] = {
      {"SE3", "a record in 3D; write x, y and yaw as VERTEX_SE2 and EDGE_SE2"},
      {"VERTEX3", "a record in 3D; write x, y and yaw as VERTEX2 and EDGE2"},
      {"EDGE3", "a record in 3D; write x, y and yaw as VERTEX2 and EDGE2"},
      {"SIM3", "a record in 3D; write x, y and yaw as VERTEX_SE2 and EDGE_SE2"},
      {"EQUIV", "two vertices of one pose (TORO); write an EDGE2 of no length between them"},
      {"SWITCH",
       "a switchable constraint (Vertigo); write it as EDGE_SE2 and leave the switches "
       "out: edges that the scans contradict do not count anyway"},
      {"MAXMIX", "a mixture of constraints; write its likely component as EDGE_SE2"},
      {"XY",
       "a landmark; leave landmarks and their edges out: poses and edges between them, and "
       "scans, are read"},
      {"PRIOR",
       "a prior on a pose; write FIX with the id of a vertex that is known, or leave it "
       "out"},
      {"LANDMARK", "a landmark; leave landmarks and their edges out"}};
  for (const auto& record : kRecords) {
    if (Contains(keyword, record.part)) return record.text;
  }
  return "a record that is not understood";
}

Eigen::Matrix3d ReadInformation(const PoseGraphDialect& dialect, FieldReader* fields) {
  Eigen::Matrix3d information;
  for (const char* field : dialect.information) {
    const int row = field[1] - '1', column = field[2] - '1';
    information(row, column) = information(column, row) = fields->FiniteNumber(field);
  }
  return information;
}

// Collects the records of one file, then makes a graph of them.
class Parser {
 public:
  Parser(std::string path, double max_bytes)
      : path_(std::move(path)), max_bytes_(max_bytes), memory_(max_bytes) {}

  Status ParseLine(std::string_view line) {
    file_.lines.emplace_back(line);
    if (!memory_.Keep(line.size() + sizeof(std::string))) {
      return Error(file_.lines.size(), memory_.Fault());
    }
    const std::string_view keyword = RecordKeyword(line);
    if (keyword.empty() || StartsWith(keyword, "PARAMS_")) return Status::Ok();
    if (dialect_ == nullptr) dialect_ = DialectOfKeyword(keyword);
    FieldReader fields(line);
    fields.Word("keyword");
    if (dialect_ != nullptr && keyword == dialect_->vertex) {
      ReadVertex(&fields);
    } else if (dialect_ != nullptr && keyword == dialect_->edge) {
      ReadEdge(&fields);
    } else if (keyword == "FIX") {
      ReadFix(&fields);
    } else if (keyword == kLaser) {
      if (poses_.empty()) fields.Fail("keyword", "no vertex before it");
      pose_of_laser_line_[file_.lines.size()] = static_cast<int>(poses_.size()) - 1;
    } else {
      fields.Fail("keyword", UnknownRecordText(keyword));
    }
    return fields.ok() ? Status::Ok() : Error(file_.lines.size(), fields.error());
  }

  Status Finish(PoseGraphFile* file) {
    if (poses_.empty()) return Status::InvalidArgument(path_ + ": the file holds no vertices");
    file_.format = dialect_->format;
    CarmenLog log;
    PLUMBLINE_RETURN_IF_ERROR(ReadScans(&log));
    AddPoses(log);
    PLUMBLINE_RETURN_IF_ERROR(AddScans(log));
    PLUMBLINE_RETURN_IF_ERROR(AddEdges());
    PLUMBLINE_RETURN_IF_ERROR(FixPoses());
    const int unconnected = FindUnconnectedPose(file_.graph, {0});
    if (unconnected >= 0) {
      return Error(vertex_lines_[unconnected] + 1,
                   "no edges connect vertex " + std::to_string(file_.vertex_ids[unconnected]) +
                       " with the first vertex, " + std::to_string(file_.vertex_ids[0]));
    }
    *file = std::move(file_);
    return Status::Ok();
  }

 private:
  struct Edge {
    long long from = 0, to = 0;
    Pose2 from_from_to;
    Eigen::Matrix3d information;
    std::size_t line = 0;
  };
  struct Fix {
    long long id = 0;
    std::size_t line = 0;
  };

  void ReadVertex(FieldReader* fields) {
    const long long id = ReadId(fields, "id");
    const Pose2 pose = ReadPoseFields(fields);
    fields->ExpectEnd();
    const auto [known, added] = pose_of_id_.emplace(id, static_cast<int>(poses_.size()));
    if (!added) {
      fields->Fail("id", "vertex " + std::to_string(id) + " was there before, in line " +
                             std::to_string(vertex_lines_[known->second] + 1));
    }
    poses_.push_back(pose);
    file_.vertex_ids.push_back(id);
    vertex_lines_.push_back(file_.lines.size() - 1);
  }

  void ReadEdge(FieldReader* fields) {
    Edge edge;
    edge.from = ReadId(fields, "from");
    edge.to = ReadId(fields, "to");
    edge.from_from_to = ReadPoseFields(fields);
    edge.information = ReadInformation(*dialect_, fields);
    fields->ExpectEnd();
    if (edge.from == edge.to) fields->Fail("to", "the edge joins a vertex with itself");
    edge.line = file_.lines.size();
    edges_.push_back(edge);
  }

  void ReadFix(FieldReader* fields) {
    do {
      fixes_.push_back({ReadId(fields, "id"), file_.lines.size()});
    } while (fields->ok() && !FieldReader(*fields).Word("id").empty());
  }

  // The scans in the order of their lines, which is that of their vertices.
  Status ReadScans(CarmenLog* log) const {
    if (pose_of_laser_line_.empty()) return Status::Ok();
    CarmenReadOptions strict;
    strict.bad_records.max_share = 0.0;
    strict.bad_records.max_records = 0;
    strict.max_bytes = max_bytes_;
    PLUMBLINE_RETURN_IF_ERROR(ReadCarmenLog(path_, strict, log));
    std::sort(log->scans.begin(), log->scans.end(),
              [](const CarmenScan& a, const CarmenScan& b) { return a.line < b.line; });
    const std::string disagreement = EstimateLaserMounting(*log).Disagreement();
    if (disagreement.empty()) return Status::Ok();
    return Status::InvalidArgument(path_ + ": " + disagreement + "; one laser is expected");
  }

  void AddPoses(const CarmenLog& log) {
    std::vector<double> times(poses_.size());
    std::iota(times.begin(), times.end(), 0.0);
    for (auto scan = log.scans.rbegin(); scan != log.scans.rend(); ++scan) {
      times[pose_of_laser_line_.at(scan->line)] = scan->timestamp_s;
    }
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      file_.graph.AddPose(poses_[i], times[i]);
    }
  }

  Status AddScans(const CarmenLog& log) {
    if (log.scans.empty()) return Status::Ok();
    SlamGraph of_log;  // for the lasers of its scans
    const Status status = BuildGraph(log, 0, &of_log);
    if (!status.ok()) return Status::InvalidArgument(path_ + ": " + status.message());
    for (int s = 0; s < of_log.num_scans(); ++s) {
      const int laser = file_.graph.AddLaser(of_log.LaserOfScan(s));
      const int pose = pose_of_laser_line_.at(log.scans[s].line);
      file_.graph.AddScan(pose, laser, log.scans[s].ranges);
    }
    return file_.graph.status();
  }

  Status AddEdges() {
    for (const Edge& edge : edges_) {
      RelativePoseConstraint constraint;
      PLUMBLINE_RETURN_IF_ERROR(FindPose(edge.from, "from", edge.line, &constraint.from));
      PLUMBLINE_RETURN_IF_ERROR(FindPose(edge.to, "to", edge.line, &constraint.to));
      constraint.from_from_to = edge.from_from_to;
      // The information has the axes of the pose measured, ours has those of `from`.
      const Eigen::Matrix3d covariance =
          RotateAxes(edge.information.inverse(), edge.from_from_to.yaw);
      constraint.covariance = 0.5 * (covariance + covariance.transpose());
      // Ids and numbers are known to be good.
      file_.graph.AddRelativePose(constraint);
      if (!file_.graph.status().ok()) {
        return Error(edge.line,
                     "fields 'I11' to 'I33': the information is not positive definite, or "
                     "a standard deviation is not within 1e-9 and 1e9");
      }
    }
    return Status::Ok();
  }

  Status FixPoses() {
    for (const Fix& fix : fixes_) {
      int pose = 0;
      PLUMBLINE_RETURN_IF_ERROR(FindPose(fix.id, "id", fix.line, &pose));
      file_.graph.FixPose(pose);
    }
    return Status::Ok();
  }

  Status FindPose(long long id, const char* field, std::size_t line, int* pose) const {
    const auto known = pose_of_id_.find(id);
    if (known == pose_of_id_.end()) {
      return Error(line,
                   "field '" + std::string(field) + "': there is no vertex " + std::to_string(id));
    }
    *pose = known->second;
    return Status::Ok();
  }

  // line: from 1.
  Status Error(std::size_t line, const std::string& problem) const {
    return Status::InvalidArgument(path_ + ":" + std::to_string(line) + ": " +
                                   Printable(RecordKeyword(file_.lines[line - 1])) + " " + problem);
  }

  const std::string path_;
  const double max_bytes_;
  MemoryLimit memory_;
  const PoseGraphDialect* dialect_ = nullptr;  // that of the first vertex or edge
  PoseGraphFile file_;
  std::vector<Pose2> poses_;
  std::vector<std::size_t> vertex_lines_;  // index into the file's lines
  std::unordered_map<long long, int> pose_of_id_;
  std::unordered_map<std::size_t, int> pose_of_laser_line_;
  std::vector<Edge> edges_;
  std::vector<Fix> fixes_;
};

}  // namespace

const char* ToString(PoseGraphFormat format) {
  return format == PoseGraphFormat::kG2o ? "g2o" : "toro";
}

bool IsPoseGraphFile(const std::string& path) {
  TextReader reader;
  if (!reader.Open(path).ok()) return false;
  std::string_view line;
  while (reader.NextLine(&line)) {
    const std::string_view keyword = RecordKeyword(line);
    if (keyword.empty()) continue;
    return StartsWith(keyword, "VERTEX") || StartsWith(keyword, "EDGE") || keyword == "FIX" ||
           StartsWith(keyword, "PARAMS_") || (keyword == kLaser && HasPoseGraphExtension(path));
  }
  return HasPoseGraphExtension(path);
}

Status ReadPoseGraphFile(const std::string& path, PoseGraphFile* file, double max_bytes) {
  TextReader reader;
  PLUMBLINE_RETURN_IF_ERROR(reader.Open(path));
  Parser parser(path, max_bytes);
  std::string_view line;
  while (reader.NextLine(&line)) PLUMBLINE_RETURN_IF_ERROR(parser.ParseLine(line));
  PLUMBLINE_RETURN_IF_ERROR(reader.CheckWhole());
  return parser.Finish(file);
}

}  // namespace plumbline
