// Refines a pose graph with scans, as another system has saved it: reads a g2o file, estimates all
// poses and all laser returns together, and writes the file again with the refined poses; all other
// lines stay as they were. To refine graphs of another format, replace ParseLine and WriteGraph.
//
//   plumbline_example_refine_g2o IN.g2o OUT.g2o
//
// The edges alone come first, then edges and returns together, which is never worse than the edges'
// optimum by the energy of both: if it is no better either, the edges' poses stay, and the program
// says so. Exit code 0 unless the input cannot be read or the output cannot be written.
#include <plumbline/core/slam_graph.h>
#include <plumbline/solvers/solve.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

using plumbline::Pose2;
using plumbline::Status;

namespace {

// The file, and the graph made of it, whose initial guesses are the file's poses.
struct G2oGraph {
  std::vector<std::string> lines;
  std::vector<std::size_t> vertex_lines;  // of each pose
  std::map<long long, int> pose_of_id;
  plumbline::SlamGraph graph;
};

// Edges and fixed vertices may be named before the vertices.
struct Edge {
  long long from = 0, to = 0;
  plumbline::RelativePoseConstraint constraint;
  std::size_t line = 0;
};
struct Fix {
  long long id = 0;
  std::size_t line = 0;
};

// Reads numbers as a stream does, and nothing else: "nan" is one for laser readings only.
double Reading(std::istream& fields) {
  std::string word;
  fields >> word;
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (word.empty() || *end != '\0') fields.setstate(std::ios::failbit);
  return value;
}

class G2oReader {
 public:
  explicit G2oReader(G2oGraph* g2o) : g2o_(g2o) {}

  Status Read(const std::string& path) {
    std::ifstream file(path);
    if (!file) return Status::NotFound("cannot open " + path);
    std::string line;
    while (std::getline(file, line)) {
      g2o_->lines.push_back(line);
      const Status status = ParseLine(line);
      if (!status.ok()) return At(path, g2o_->lines.size(), status);
    }
    for (const Edge& edge : edges_) {
      const Status status = AddEdge(edge);
      if (!status.ok()) return At(path, edge.line, status);
    }
    for (const Fix& fix : fixes_) {
      int pose = 0;
      Status status = FindPose(fix.id, &pose);
      if (status.ok()) {
        g2o_->graph.FixPose(pose);
        status = g2o_->graph.status();
      }
      if (!status.ok()) return At(path, fix.line, status);
    }
    if (g2o_->graph.num_poses() > 0) return Status::Ok();
    return Status::InvalidArgument(path + ": there is no VERTEX_SE2");
  }

 private:
  static Status At(const std::string& path, std::size_t line, const Status& status) {
    return Status::InvalidArgument(path + ":" + std::to_string(line) + ": " + status.message());
  }

  Status ParseLine(const std::string& line) {
    std::istringstream fields(line);
    std::string keyword;
    fields >> keyword;
    if (keyword.empty() || keyword[0] == '#' || keyword.rfind("PARAMS_", 0) == 0) {
      return Status::Ok();
    }
    if (keyword == "VERTEX_SE2") return ParseVertex(fields);
    if (keyword == "EDGE_SE2") return ParseEdge(fields);
    if (keyword == "FIX") return ParseFix(fields);
    if (keyword == "ROBOTLASER1") return ParseLaser(fields);
    return Status::InvalidArgument(keyword + " is not understood");
  }

  Status ParseVertex(std::istream& fields) {
    long long id = 0;
    Pose2 pose;
    if (!(fields >> id >> pose.x >> pose.y >> pose.yaw)) {
      return Status::InvalidArgument("VERTEX_SE2 wants: id x y yaw");
    }
    const int index = g2o_->graph.AddPose(pose, static_cast<double>(g2o_->graph.num_poses()));
    if (!g2o_->pose_of_id.emplace(id, index).second) {
      return Status::InvalidArgument("vertex " + std::to_string(id) + " was there before");
    }
    g2o_->vertex_lines.push_back(g2o_->lines.size() - 1);
    return g2o_->graph.status();
  }

  Status ParseEdge(std::istream& fields) {
    Edge edge;
    Pose2& motion = edge.constraint.from_from_to;
    fields >> edge.from >> edge.to >> motion.x >> motion.y >> motion.yaw;
    Eigen::Matrix3d information;
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) {
        fields >> information(row, column);
        information(column, row) = information(row, column);
      }
    }
    if (!fields) {
      return Status::InvalidArgument("EDGE_SE2 wants: from to x y yaw I11 I12 I13 I22 I23 I33");
    }
    // g2o measures errors in the axes of the second pose, Plumbline in those of the first.
    const Eigen::Matrix3d to_axes_of_from =
        Eigen::AngleAxisd(motion.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Matrix3d covariance =
        to_axes_of_from * information.inverse() * to_axes_of_from.transpose();
    edge.constraint.covariance = 0.5 * (covariance + covariance.transpose());
    edge.line = g2o_->lines.size();
    edges_.push_back(edge);
    return Status::Ok();
  }

  Status ParseFix(std::istream& fields) {
    Fix fix;
    fix.line = g2o_->lines.size();
    while (fields >> fix.id) fixes_.push_back(fix);
    if (fields.eof()) return Status::Ok();
    return Status::InvalidArgument("FIX wants: id ...");
  }

  // CARMEN's record: a scan taken at the vertex read last, with the poses that laser and robot had.
  Status ParseLaser(std::istream& fields) {
    plumbline::LaserModel laser;
    double type, field_of_view, accuracy, remission_mode;
    fields >> type >> laser.first_bearing_rad >> field_of_view >> laser.bearing_step_rad >>
        laser.max_range_m >> accuracy >> remission_mode >> laser.num_beams;
    if (!fields || laser.num_beams <= 0 || laser.num_beams > 100000) {
      return Status::InvalidArgument("ROBOTLASER1 wants: type start fov step max accuracy mode n");
    }
    std::vector<double> ranges(laser.num_beams);
    for (double& range_m : ranges) range_m = Reading(fields);
    int num_remissions = 0;
    fields >> num_remissions;
    for (int i = 0; i < num_remissions && fields; ++i) Reading(fields);
    Pose2 from_laser, from_robot;
    fields >> from_laser.x >> from_laser.y >> from_laser.yaw >> from_robot.x >> from_robot.y >>
        from_robot.yaw;
    if (!fields) {
      return Status::InvalidArgument(
          "ROBOTLASER1 wants: ... r1..rn m i1..im laser pose robot pose");
    }
    if (g2o_->graph.num_poses() == 0) return Status::InvalidArgument("no vertex before the scan");
    // The same for all scans but for the rounding of the file: one laser then, not thousands.
    if (g2o_->graph.num_lasers() == 0) robot_from_laser_ = Between(from_robot, from_laser);
    laser.robot_from_laser = robot_from_laser_;
    const int id = g2o_->graph.AddLaser(laser);
    g2o_->graph.AddScan(g2o_->graph.num_poses() - 1, id, ranges);
    return g2o_->graph.status();
  }

  Status FindPose(long long id, int* pose) const {
    const auto known = g2o_->pose_of_id.find(id);
    if (known == g2o_->pose_of_id.end()) {
      return Status::NotFound("there is no vertex " + std::to_string(id));
    }
    *pose = known->second;
    return Status::Ok();
  }

  Status AddEdge(Edge edge) {
    PLUMBLINE_RETURN_IF_ERROR(FindPose(edge.from, &edge.constraint.from));
    PLUMBLINE_RETURN_IF_ERROR(FindPose(edge.to, &edge.constraint.to));
    g2o_->graph.AddRelativePose(edge.constraint);
    return g2o_->graph.status();
  }

  G2oGraph* const g2o_;
  std::vector<Edge> edges_;
  std::vector<Fix> fixes_;
  Pose2 robot_from_laser_;
};

Status WriteGraph(const std::string& path, const G2oGraph& g2o, const plumbline::MapState& state) {
  std::vector<std::string> lines = g2o.lines;
  for (const auto& [id, index] : g2o.pose_of_id) {
    const Pose2 pose = state.WorldFromRobot(index);
    char text[160];
    std::snprintf(text, sizeof(text), "VERTEX_SE2 %lld %.17g %.17g %.17g", id, pose.x, pose.y,
                  plumbline::NormalizeAngle(pose.yaw));
    lines[g2o.vertex_lines[index]] = text;
  }
  std::ofstream file(path);
  for (const std::string& line : lines) file << line << '\n';
  file.flush();
  return file ? Status::Ok() : Status::Unavailable("cannot write " + path);
}

// The edges alone first: the joint estimation wants poses that are right to a few decimetres. If a
// file was refined before, and its edges are poorer than its poses, leave that out.
Status Refine(const plumbline::SlamGraph& graph, plumbline::MapState* state) {
  if (!graph.relative_poses().empty()) {
    plumbline::SolverOptions by_edges;
    by_edges.type = plumbline::SolverType::kPoseGraph;
    const plumbline::Solution edges = plumbline::Solve(graph, by_edges);
    PLUMBLINE_RETURN_IF_ERROR(edges.status);
    std::printf("edges alone: chi2 %.6g -> %.6g\n", edges.report.seed_chi2,
                edges.report.final_chi2);
    *state = edges.State();
  }
  if (graph.num_returns() == 0) {
    std::printf("no scans: that is all\n");
    return Status::Ok();
  }
  const plumbline::Solution joint = plumbline::Solve(graph, plumbline::SolverOptions(), *state);
  PLUMBLINE_RETURN_IF_ERROR(joint.status);
  if (joint.report.termination == plumbline::TerminationType::kNoImprovement) {
    std::printf("edges and scans: no better than the start, which stays\n");
  } else {
    std::printf("edges and scans: energy %.6g -> %.6g\n", joint.report.acceptance.seed_energy,
                joint.report.acceptance.final_energy);
  }
  *state = joint.State();
  return Status::Ok();
}

Status Run(const std::string& input, const std::string& output) {
  G2oGraph g2o;
  PLUMBLINE_RETURN_IF_ERROR(G2oReader(&g2o).Read(input));
  std::printf("%s: %d poses, %zu edges, %d scans, %zu returns\n", input.c_str(),
              g2o.graph.num_poses(), g2o.graph.relative_poses().size(), g2o.graph.num_scans(),
              g2o.graph.num_returns());
  plumbline::MapState state = g2o.graph.InitialState();
  PLUMBLINE_RETURN_IF_ERROR(Refine(g2o.graph, &state));
  double sum_m = 0.0, most_m = 0.0;
  for (int i = 0; i < state.num_poses(); ++i) {
    const Pose2 moved = Between(g2o.graph.InitialPose(i), state.WorldFromRobot(i));
    sum_m += moved.translation().norm();
    most_m = std::max(most_m, moved.translation().norm());
  }
  std::printf("poses moved by %.4f m in the mean, %.4f m at most\n", sum_m / state.num_poses(),
              most_m);
  return WriteGraph(output, g2o, state);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s IN.g2o OUT.g2o\n", argv[0]);
    return 1;
  }
  const Status status = Run(argv[1], argv[2]);
  if (!status.ok()) std::fprintf(stderr, "%s\n", status.message().c_str());
  return status.ok() ? 0 : 1;
}
