#include "plumbline/solvers/map_sessions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/evaluation/pose_errors.h"
#include "plumbline/apps/simulation/building_generator.h"
#include "plumbline/apps/simulation/floor.h"
#include "plumbline/apps/simulation/log_graph.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/partition.h"
#include "plumbline/core/share_graph.h"
#include "plumbline/core/thread_pool.h"
#include "plumbline/test/core/thread_peers.h"

namespace plumbline {
namespace {

using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Two of the buildings with the shortest drives.
constexpr std::uint64_t kHome = 43, kElsewhere = 34;

// A drive through a building on one of several days, from where nobody knows.
SimulatedLog Visit(BuildingKind kind, std::uint64_t building, std::uint64_t visit,
                   int num_beams = 90) {
  SimulationOptions options;
  options.seed = 10 * building + visit;
  options.scan_period_s = 1.0;
  options.laser.num_beams = num_beams;
  options.laser.bearing_step_rad = kPi / num_beams;
  SimulatedLog log;
  EXPECT_TRUE(Simulate(World(GenerateVisit(kind, building, visit)), options, &log).ok());
  return log;
}

// As in the study of sessions (apps/benchmark): another drive, with a scan every 0.18 m.
SimulatedLog StudiedVisit(BuildingKind kind, std::uint64_t building, std::uint64_t visit) {
  SimulationOptions options;
  options.seed = SeedOfVisit(building, visit);
  options.scan_period_s = 0.45;
  SimulatedLog log;
  EXPECT_TRUE(Simulate(World(GenerateVisit(kind, building, visit)), options, &log).ok());
  return log;
}

SlamGraph GraphOf(const SimulatedLog& log) {
  SlamGraph graph;
  EXPECT_TRUE(MakeGraph(log, &graph).ok());
  return graph;
}

std::vector<SlamGraph> GraphsOf(const std::vector<SimulatedLog>& logs) {
  std::vector<SlamGraph> graphs;
  for (const SimulatedLog& log : logs) graphs.push_back(GraphOf(log));
  return graphs;
}

std::vector<SimulatedLog> TwoVisits() {
  return {Visit(BuildingKind::kRandom, kHome, 0), Visit(BuildingKind::kRandom, kHome, 1)};
}

SessionsMapping Mapped(std::vector<SlamGraph> sessions, int num_threads = 2) {
  MapLogOptions options;
  options.solver.num_threads = num_threads;
  SessionsMapping mapping;
  const Status status = MapSessions(options, std::move(sessions), nullptr, &mapping);
  EXPECT_TRUE(status.ok()) << status.message();
  return mapping;
}

std::vector<LogMapping> TakenOver(std::vector<SlamGraph> sessions, ThreadPool* pool) {
  std::vector<LogMapping> taken(sessions.size());
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    EXPECT_TRUE(TakeLog(MapLogOptions(), std::move(sessions[i]), pool, &taken[i]).ok());
  }
  return taken;
}

// The worst pose of a map, after one rigid motion of all of it [m].
double WorstM(const SessionMap& map, const std::vector<SimulatedLog>& logs) {
  std::vector<Pose2> truth;
  for (const SessionOfMap& session : map.sessions) {
    for (const SimulatedScan& scan : logs[session.session].scans) {
      truth.push_back(scan.world_from_robot);
    }
  }
  PoseErrors errors(StatisticsConvention::kEvo);
  errors.AddFitted(truth, PosesOf(map.mapping.state.poses));
  return errors.Statistics().translation_m.max;
}

std::vector<int> SessionsOf(const SessionMap& map) {
  std::vector<int> sessions;
  for (const SessionOfMap& session : map.sessions) sessions.push_back(session.session);
  std::sort(sessions.begin(), sessions.end());
  return sessions;
}

// The graph of a map has all that its sessions have, in their order.
void ExpectWhole(const SessionMap& map, const std::vector<SimulatedLog>& logs) {
  const SlamGraph& graph = map.mapping.graph;
  int num_poses = 0, num_scans = 0;
  for (const SessionOfMap& session : map.sessions) {
    EXPECT_EQ(session.first_pose, num_poses);
    EXPECT_EQ(session.first_scan, num_scans);
    num_poses += session.num_poses;
    num_scans += session.num_scans;
    const SimulatedLog& log = logs[session.session];
    EXPECT_EQ(session.num_scans, static_cast<int>(log.scans.size()));
    EXPECT_EQ(graph.timestamp_s(session.first_pose), log.scans.front().scan.timestamp_s);
  }
  EXPECT_EQ(graph.num_poses(), num_poses);
  EXPECT_EQ(graph.num_scans(), num_scans);
  EXPECT_EQ(graph.odometry().size(), num_poses - map.sessions.size());
  for (const OdometryConstraint& step : graph.odometry()) EXPECT_EQ(step.to, step.from + 1);
}

// Edges of the seed from one session to another are closures.
void ExpectClosuresBetweenSessions(const SessionMap& map) {
  const SeedingReport& seeding = map.mapping.report.seeding;
  int num_across = 0;
  for (const RelativePoseConstraint& edge : seeding.pose_graph) {
    for (const SessionOfMap& session : map.sessions) {
      if (session.first_pose == 0) continue;
      EXPECT_FALSE(edge.from == session.first_pose - 1 && edge.to == session.first_pose);
      if (edge.from < session.first_pose && edge.to >= session.first_pose) ++num_across;
    }
  }
  EXPECT_GE(num_across, 6);
  EXPECT_EQ(seeding.pose_graph.size(),
            map.mapping.graph.odometry().size() + seeding.loops.num_closures);
}

void ExpectSame(const Pose2& actual, const Pose2& expected) {
  EXPECT_NEAR(actual.x, expected.x, 1e-9);
  EXPECT_NEAR(actual.y, expected.y, 1e-9);
  EXPECT_NEAR(actual.yaw, expected.yaw, 1e-9);
}

TEST(MapSessionsTest, VisitsOfOneBuildingMakeOneMapInAnyOrder) {
  const std::vector<SimulatedLog> logs{Visit(BuildingKind::kRandom, kHome, 2),
                                       Visit(BuildingKind::kRandom, kHome, 0),
                                       Visit(BuildingKind::kRandom, kHome, 1, 120)};
  const SessionsMapping mapping = Mapped(GraphsOf(logs));
  ASSERT_THAT(mapping.maps, SizeIs(1));
  const SessionMap& map = mapping.maps.front();
  EXPECT_THAT(SessionsOf(map), ElementsAre(0, 1, 2));
  EXPECT_LT(WorstM(map, logs), 0.05);
  EXPECT_THAT(map.mapping.report.alarms, IsEmpty());
  ASSERT_THAT(mapping.ties, SizeIs(2));
  for (const SessionTie& tie : mapping.ties) EXPECT_EQ(tie.outcome, TieOutcome::kTied);
  EXPECT_EQ(map.mapping.graph.num_lasers(), 2);
  ExpectWhole(map, logs);
  ExpectClosuresBetweenSessions(map);
  // The frame is that of the first session.
  EXPECT_EQ(map.sessions.front().session, 0);
  ExpectSame(Pose2(map.mapping.state.poses.data()), GraphOf(logs.front()).InitialPose(0));
}

TEST(MapSessionsTest, AnyNumberOfThreadsGivesTheSameBits) {
  const SessionsMapping one = Mapped(GraphsOf(TwoVisits()), 1);
  const SessionsMapping three = Mapped(GraphsOf(TwoVisits()), 3);
  ASSERT_THAT(one.maps, SizeIs(1));
  ASSERT_THAT(three.maps, SizeIs(1));
  EXPECT_EQ(one.maps.front().mapping.state.poses, three.maps.front().mapping.state.poses);
}

TEST(MapSessionsTest, OtherBuildingsGetMapsOfTheirOwn) {
  const std::vector<SimulatedLog> logs{Visit(BuildingKind::kRandom, kHome, 0),
                                       Visit(BuildingKind::kRandom, kElsewhere, 0),
                                       Visit(BuildingKind::kRandom, kHome, 1)};
  const SessionsMapping mapping = Mapped(GraphsOf(logs));
  ASSERT_THAT(mapping.maps, SizeIs(2));
  EXPECT_THAT(SessionsOf(mapping.maps[0]), ElementsAre(0, 2));
  EXPECT_THAT(SessionsOf(mapping.maps[1]), ElementsAre(1));
  for (const SessionMap& map : mapping.maps) EXPECT_LT(WorstM(map, logs), 0.05);
  ASSERT_THAT(mapping.ties, SizeIs(2));
  EXPECT_EQ(mapping.ties[0].outcome, TieOutcome::kTied);
  EXPECT_NE(mapping.ties[1].outcome, TieOutcome::kTied);
}

// In a corridor without features a cupboard was moved by 0.25 m.
TEST(MapSessionsTest, FurnitureThatWasMovedBendsNoSession) {
  const std::vector<SimulatedLog> logs{StudiedVisit(BuildingKind::kRandom, 17, 0),
                                       StudiedVisit(BuildingKind::kRandom, 17, 1)};
  const SessionsMapping mapping = Mapped(GraphsOf(logs));
  ASSERT_THAT(mapping.maps, SizeIs(1));
  EXPECT_LT(WorstM(mapping.maps.front(), logs), 0.08);
  EXPECT_THAT(mapping.maps.front().mapping.report.alarms, IsEmpty());
}

// Their corridors and rooms are alike, but for some centimetres each.
TEST(MapSessionsTest, BuildingsAlikeButForTheirDimensionsAreNotTied) {
  const SessionsMapping mapping =
      Mapped(GraphsOf({StudiedVisit(BuildingKind::kRepetitive, 12, 1),
                       StudiedVisit(BuildingKind::kRepetitive, 1012, 0)}));
  EXPECT_THAT(mapping.maps, SizeIs(2));
  ASSERT_THAT(mapping.ties, SizeIs(1));
  EXPECT_THAT(mapping.ties.front().outcome, AnyOf(TieOutcome::kBent, TieOutcome::kContradicted));
}

// Half a turn puts such a building on itself: nothing tells which way round a robot started.
TEST(MapSessionsTest, WhatFitsInTwoWaysIsNotTied) {
  const SessionsMapping mapping = Mapped(
      GraphsOf({Visit(BuildingKind::kRepetitive, 3, 0), Visit(BuildingKind::kRepetitive, 3, 1)}));
  EXPECT_THAT(mapping.maps, SizeIs(2));
  ASSERT_THAT(mapping.ties, SizeIs(1));
  EXPECT_EQ(mapping.ties.front().outcome, TieOutcome::kAmbiguous);
}

TEST(MapSessionsTest, OneSessionIsMappedAsALog) {
  const SlamGraph session = GraphOf(Visit(BuildingKind::kRandom, kHome, 0));
  LogMapping alone;
  ASSERT_TRUE(MapLog(MapLogOptions(), session, nullptr, &alone).ok());
  const SessionsMapping mapping = Mapped({session});
  ASSERT_THAT(mapping.maps, SizeIs(1));
  EXPECT_EQ(mapping.maps.front().mapping.state.poses, alone.state.poses);
  EXPECT_THAT(mapping.ties, IsEmpty());
}

TEST(MapSessionsTest, SessionsWithoutOdometryAreTied) {
  const std::vector<SimulatedLog> logs = TwoVisits();
  SlamGraph blind;
  const SlamGraph seeing = GraphOf(logs[1]);
  for (int pose = 0; pose < seeing.num_poses(); ++pose) {
    blind.AddPose(Pose2(), seeing.timestamp_s(pose));
    blind.AddScanOf(seeing, pose, pose);
  }
  const SessionsMapping mapping = Mapped({GraphOf(logs[0]), blind});
  ASSERT_THAT(mapping.maps, SizeIs(1));
  EXPECT_LT(WorstM(mapping.maps.front(), logs), 0.05);
}

TEST(MapSessionsTest, BadInputIsRefused) {
  const auto refusal = [](const MapLogOptions& options, std::vector<SlamGraph> sessions) {
    SessionsMapping mapping;
    const Status status = MapSessions(options, std::move(sessions), nullptr, &mapping);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    return status.message();
  };
  const SlamGraph good = GraphOf(Visit(BuildingKind::kRandom, kHome, 0));
  EXPECT_THAT(refusal(MapLogOptions(), {}), HasSubstr("no session"));
  EXPECT_THAT(refusal(MapLogOptions(), {good, SlamGraph()}), HasSubstr("session 2"));
  SlamGraph blank;
  blank.AddPose(Pose2(), 0.0);
  const std::vector<double> nothing(good.laser(0).num_beams, good.laser(0).max_range_m);
  blank.AddScan(0, blank.AddLaser(good.laser(0)), nothing);
  EXPECT_THAT(refusal(MapLogOptions(), {good, blank}), HasSubstr("session 2"));
  MapLogOptions options;
  options.start = StartType::kOdometry;
  EXPECT_THAT(refusal(options, {good, good}), HasSubstr("odometry"));
  options = MapLogOptions();
  options.calibration.laser_mounting = true;
  EXPECT_THAT(refusal(options, {good, good}), HasSubstr("calibration"));
  options = MapLogOptions();
  options.solver.type = SolverType::kPoseGraph;
  EXPECT_THAT(refusal(options, {good, good}), HasSubstr("pose_graph"));
}

TEST(MapSessionsTest, AFinishedMapStaysWhereItIs) {
  const std::vector<SimulatedLog> logs = TwoVisits();
  std::vector<SlamGraph> sessions = GraphsOf(logs);
  LogMapping finished;
  ASSERT_TRUE(MapLog(MapLogOptions(), sessions[1], nullptr, &finished).ok());
  // Elsewhere in the world.
  const Pose2 world_from_map(30.0, -20.0, 2.0);
  std::vector<Pose2> poses = PosesOf(finished.state.poses);
  for (int pose = 0; pose < sessions[1].num_poses(); ++pose) {
    poses[pose] = world_from_map * poses[pose];
    sessions[1].FixPose(pose, poses[pose]);
  }
  const SessionsMapping mapping = Mapped(sessions);
  ASSERT_THAT(mapping.maps, SizeIs(1));
  const SessionMap& map = mapping.maps.front();
  const std::vector<double> held(map.mapping.state.poses.begin() + 3 * map.sessions[1].first_pose,
                                 map.mapping.state.poses.end());
  EXPECT_EQ(held, PoseArray(poses));
  EXPECT_LT(WorstM(map, logs), 0.05);
}

TEST(MapSessionsTest, AMapMayNotBeHeldInPart) {
  std::vector<SlamGraph> sessions = GraphsOf(TwoVisits());
  SessionsMapping mapping;
  sessions[0].FixPose(0);
  const Status part = MapSessions(MapLogOptions(), sessions, nullptr, &mapping);
  EXPECT_EQ(part.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(part.message(), HasSubstr("session 1: some of its poses are fixed"));
  for (SlamGraph& session : sessions) {
    for (int pose = 0; pose < session.num_poses(); ++pose) {
      session.FixPose(pose);
    }
  }
  const Status two = MapSessions(MapLogOptions(), sessions, nullptr, &mapping);
  EXPECT_EQ(two.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(two.message(), HasSubstr("session 2: its poses are fixed, and so are those"));
}

// Also of three sessions that do not all become one map.
TEST(MapSessionsTest, ProcessesFindTheSeedsOfOneProcess) {
  std::vector<SimulatedLog> logs = TwoVisits();
  logs.push_back(Visit(BuildingKind::kRandom, kElsewhere, 0));
  ThreadPool pool(1);
  const std::vector<LogMapping> taken = TakenOver(GraphsOf(logs), &pool);
  SessionsMapping expected;
  ASSERT_TRUE(SeedSessions(MapLogOptions(), taken, nullptr, &pool, &expected).ok());
  ASSERT_THAT(expected.maps, SizeIs(2));
  constexpr int kSize = 3;
  RunOnPeers(kSize, [&](const Peers& peers) {
    ThreadPool one_thread(1);
    std::vector<LogMapping> parts = taken;
    for (LogMapping& part : parts) {
      ASSERT_TRUE(
          ShareGraph(&peers, PartitionByTime(part.graph.num_poses(), kSize), &part.graph).ok());
    }
    SessionsMapping mapping;
    const auto stop = [](SeedingPhase, int, int) { return false; };  // others would wait
    ASSERT_TRUE(SeedSessions(MapLogOptions(), std::move(parts), stop, &one_thread, &mapping).ok());
    ASSERT_EQ(mapping.ties.size(), expected.ties.size());
    for (std::size_t i = 0; i < mapping.ties.size(); ++i) {
      EXPECT_EQ(mapping.ties[i].outcome, expected.ties[i].outcome);
      EXPECT_EQ(mapping.ties[i].num_closures, expected.ties[i].num_closures);
      EXPECT_EQ(mapping.ties[i].conflict.num_compared, expected.ties[i].conflict.num_compared);
    }
    ASSERT_EQ(mapping.maps.size(), expected.maps.size());
    for (std::size_t i = 0; i < mapping.maps.size(); ++i) {
      const LogMapping &own = mapping.maps[i].mapping, &of_one = expected.maps[i].mapping;
      EXPECT_EQ(SessionsOf(mapping.maps[i]), SessionsOf(expected.maps[i]));
      EXPECT_EQ(own.start_poses, of_one.start_poses);
      EXPECT_EQ(own.graph.rank_of_pose(),
                PartitionByPlace(of_one.start_poses, ReturnsPerPose(of_one.graph), kSize));
      EXPECT_EQ(own.graph.num_lasers(), of_one.graph.num_lasers());
      ASSERT_EQ(own.graph.all_scans().size(), of_one.graph.all_scans().size());
      EXPECT_EQ(own.graph.num_returns_of_all(), of_one.graph.num_returns());
      EXPECT_EQ(own.surface.normals.size(), own.graph.num_returns());
      for (int scan = 0; scan < own.graph.num_scans(); ++scan) {
        const int id = own.graph.IdAmongAll(scan);
        EXPECT_EQ(own.graph.scan(scan).pose, of_one.graph.scan(id).pose);
        EXPECT_EQ(own.graph.scan(scan).num_returns, of_one.graph.scan(id).num_returns);
      }
    }
  });
}

TEST(MapSessionsTest, ItsCallerStopsIt) {
  ThreadPool pool(2);
  const std::vector<LogMapping> sessions = TakenOver(GraphsOf(TwoVisits()), &pool);
  int num_calls = 0;
  const auto seed = [&](int last_call) {
    num_calls = 0;
    SessionsMapping mapping;
    const Status status = SeedSessions(
        MapLogOptions(), sessions, [&](SeedingPhase, int, int) { return ++num_calls != last_call; },
        &pool, &mapping);
    EXPECT_EQ(mapping.maps.empty(), !status.ok());
    return status.code();
  };
  EXPECT_EQ(seed(0), StatusCode::kOk);
  const int in_all = num_calls;
  ASSERT_GE(in_all, 10);
  for (const int last_call : {1, in_all / 2, in_all}) {
    EXPECT_EQ(seed(last_call), StatusCode::kUnavailable) << last_call << " of " << in_all;
    EXPECT_EQ(num_calls, last_call);
  }
}

}  // namespace
}  // namespace plumbline
