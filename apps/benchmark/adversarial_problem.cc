#include "plumbline/apps/benchmark/adversarial_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "plumbline/apps/benchmark/mapper_edges.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/noise_source.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/solvers/pose_graph/pose_graph.h"

namespace plumbline {
namespace {

constexpr std::uint32_t kAttackStream = 7;  // 0 to 6 belong to simulator, buildings and drift
constexpr double kDriftM = 0.03, kDriftRad = 0.005;

bool IsOfAMapper(const AdversarialCase& run) {
  return run.attack == Attack::kGrossClosures || run.attack == Attack::kBiasedClosures;
}

Status SimulateCase(const AdversarialCase& run, SimulatedLog* log) {
  SimulationOptions options;
  options.scan_period_s = IsOfAMapper(run) ? 0.375 : 0.9;  // a scan every 0.15 or 0.36 m
  options.seed = run.seed;
  if (run.attack == Attack::kJump && run.seeded) options.odometry_leap = {20.0, run.level};
  return Simulate(World(GenerateBuilding(BuildingKind::kRandom, run.seed)), options, log);
}

// `count` different numbers below `end`, the first excepted.
std::vector<int> Draw(int count, int end, NoiseSource* source) {
  std::vector<int> all;
  for (int i = 1; i < end; ++i) all.push_back(i);
  count = std::min<int>(count, static_cast<int>(all.size()));
  for (int i = 0; i < count; ++i) {
    std::swap(all[i], all[i + static_cast<int>(source->Uniform() * (all.size() - i))]);
  }
  all.resize(count);
  return all;
}

class Falsifier {
 public:
  Falsifier(const AdversarialCase& run, SimulatedLog* log)
      : run_(run), log_(*log), source_(run.seed, kAttackStream) {}

  // What a laser reports.
  void FalsifyScans() {
    const int num_scans = static_cast<int>(log_.scans.size());
    if (run_.attack == Attack::kPeople) {
      for (SimulatedScan& scan : log_.scans) AddPeople(&scan.scan.ranges);
    }
    if (run_.attack != Attack::kMirrored && run_.attack != Attack::kRepeatedScan) return;
    const int num_drawn = static_cast<int>(std::lround(run_.level * num_scans));
    for (const int i : Draw(num_drawn, num_scans, &source_)) {
      std::vector<double>& ranges = log_.scans[i].scan.ranges;
      if (run_.attack == Attack::kMirrored) {
        std::reverse(ranges.begin(), ranges.end());
      } else {
        ranges = log_.scans[static_cast<int>(source_.Uniform() * num_scans)].scan.ranges;
      }
    }
  }

  // A graph as another mapper leaves it: at the optimum of its edges.
  Status MakeMapperGraph(const std::vector<Pose2>& truth, SlamGraph* graph,
                         std::vector<char>* is_false) {
    MapperEdges mapper = MakeMapperEdges(
        truth,
        run_.attack == Attack::kGrossClosures ? FalseClosures::kGross : FalseClosures::kBiased,
        run_.level, &source_);
    std::vector<Pose2> start = truth;
    OptimizePoseGraph(mapper.edges, {}, &start);
    AddScans(start, graph);
    for (const RelativePoseConstraint& edge : mapper.edges) {
      graph->AddRelativePose(edge);
    }
    *is_false = std::move(mapper.is_false);
    return graph->status();
  }

  // A graph as a host may have it.
  Status MakeHostGraph(const std::vector<Pose2>& truth, SlamGraph* graph,
                       std::vector<char>* is_false) {
    AddScans(Start(truth), graph);
    for (int pose = 0; pose < graph->num_poses(); ++pose) {
      const bool missing =
          run_.attack == Attack::kMissingOdometry && source_.Uniform() < run_.level;
      if (pose == 0 || missing) continue;
      graph->AddOdometry(
          {pose - 1, pose,
           Between(log_.scans[pose - 1].odom_from_robot, log_.scans[pose].odom_from_robot)});
    }
    AddClosures(truth, graph, is_false);
    return graph->status();
  }

 private:
  void AddScans(const std::vector<Pose2>& start, SlamGraph* graph) const {
    const int laser = graph->AddLaser(log_.laser);
    for (std::size_t i = 0; i < start.size(); ++i) {
      const LaserScan& scan = log_.scans[i].scan;
      const int pose = graph->AddPose(start[i], scan.timestamp_s);
      graph->AddScan(pose, laser, scan.ranges);
    }
  }

  // Where a host believes that the poses are.
  std::vector<Pose2> Start(const std::vector<Pose2>& truth) {
    std::vector<Pose2> start = truth;
    double factor = run_.attack == Attack::kTruth ? 0.0 : 1.0;
    if (run_.attack == Attack::kDrift) factor = run_.level;
    AddDrift(factor, &start);
    if (run_.attack == Attack::kJump) AddJump(&start);
    if (run_.attack == Attack::kShuffled) Shuffle(&start);
    return start;
  }

  // Legs: a few neighbouring beams each.
  void AddPeople(std::vector<double>* ranges) {
    constexpr int kBeamsOfALeg = 6;
    const int num_beams = static_cast<int>(ranges->size());
    for (int begin = 0; begin < num_beams; begin += kBeamsOfALeg) {
      if (source_.Uniform() >= run_.level) continue;
      const double nearest = *std::min_element(
          ranges->begin() + begin, ranges->begin() + std::min(begin + kBeamsOfALeg, num_beams));
      const double range = nearest * (0.3 + 0.6 * source_.Uniform());
      for (int beam = begin; beam < std::min(begin + kBeamsOfALeg, num_beams); ++beam) {
        (*ranges)[beam] = range + 0.012 * source_.Gaussian();
      }
    }
  }

  void AddClosures(const std::vector<Pose2>& truth, SlamGraph* graph, std::vector<char>* is_false) {
    constexpr int kFewestBetween = 60;
    constexpr double kReachM = 1.5;
    const Eigen::Vector3d sigmas(0.03, 0.03, 0.01);
    const int num_poses = static_cast<int>(truth.size());
    for (int to = kFewestBetween; to < num_poses; to += 2) {
      int from = 0;
      const auto distance = [&](int i) {
        return (truth[i].translation() - truth[to].translation()).norm();
      };
      for (int i = 0; i + kFewestBetween <= to; ++i) from = distance(i) < distance(from) ? i : from;
      if (distance(from) > kReachM) continue;
      Pose2 motion = Between(truth[from], truth[to]) * Pose2(sigmas.x() * source_.Gaussian(),
                                                             sigmas.y() * source_.Gaussian(),
                                                             sigmas.z() * source_.Gaussian());
      is_false->push_back(run_.attack == Attack::kWrongClosures && source_.Uniform() < run_.level);
      if (is_false->back()) {
        motion = motion * Pose2(2.0 * source_.Gaussian(), 2.0 * source_.Gaussian(),
                                0.5 * source_.Gaussian());
      }
      const Eigen::Matrix3d covariance = sigmas.cwiseAbs2().asDiagonal();
      graph->AddRelativePose({from, to, motion, covariance});
    }
  }

  // Waves of 20 to 60 m along the path, zero at its start.
  void AddDrift(double factor, std::vector<Pose2>* poses) {
    constexpr double kPeriodScans[] = {60.0, 100.0, 170.0};
    for (const double period : kPeriodScans) {
      const double x = source_.Gaussian(), y = source_.Gaussian(), yaw = source_.Gaussian();
      for (std::size_t i = 0; i < poses->size(); ++i) {
        const double wave = factor * std::sin(2.0 * kPi * static_cast<double>(i) / period);
        (*poses)[i].x += kDriftM * wave * x;
        (*poses)[i].y += kDriftM * wave * y;
        (*poses)[i].yaw += kDriftRad * wave * yaw;
      }
    }
  }

  // One step is wrong, by 3 deg per metre at that.
  void AddJump(std::vector<Pose2>* poses) {
    const auto first = static_cast<std::size_t>((0.3 + 0.4 * source_.Uniform()) *
                                                static_cast<double>(poses->size()));
    const double direction = 2.0 * kPi * source_.Uniform();
    const Pose2 jump(run_.level * std::cos(direction), run_.level * std::sin(direction),
                     DegToRad(3.0) * run_.level);
    const Pose2 at = (*poses)[first];
    for (std::size_t i = first; i < poses->size(); ++i) {
      (*poses)[i] = at * jump * Between(at, (*poses)[i]);
    }
  }

  void Shuffle(std::vector<Pose2>* poses) {
    const int num_poses = static_cast<int>(poses->size());
    const int num_drawn = static_cast<int>(std::lround(run_.level * num_poses));
    const std::vector<int> drawn = Draw(num_drawn, num_poses, &source_);
    for (std::size_t i = 1; i < drawn.size(); ++i) {
      std::swap((*poses)[drawn[i - 1]], (*poses)[drawn[i]]);
    }
  }

  const AdversarialCase& run_;
  SimulatedLog& log_;
  NoiseSource source_;
};

}  // namespace

Status MakeAdversarialProblem(const AdversarialCase& run, AdversarialProblem* problem) {
  SimulatedLog log;
  PLUMBLINE_RETURN_IF_ERROR(SimulateCase(run, &log));
  AdversarialProblem result;
  for (const SimulatedScan& scan : log.scans) {
    result.truth.push_back(Between(log.scans[0].world_from_robot, scan.world_from_robot));
  }
  Falsifier falsifier(run, &log);
  falsifier.FalsifyScans();
  if (run.seeded) {
    PLUMBLINE_RETURN_IF_ERROR(MakeGraph(log, &result.graph));
  } else if (IsOfAMapper(run)) {
    PLUMBLINE_RETURN_IF_ERROR(
        falsifier.MakeMapperGraph(result.truth, &result.graph, &result.is_false));
  } else {
    PLUMBLINE_RETURN_IF_ERROR(
        falsifier.MakeHostGraph(result.truth, &result.graph, &result.is_false));
  }
  *problem = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
