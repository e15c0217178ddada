// plumbline_live with a robot on another implementation of DDS, each in a process of its own.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "plumbline/apps/live/live_node.h"
#include "plumbline/apps/live/ros_encoder.h"
#include "plumbline/apps/live/save_live_map.h"
#include "plumbline/test/apps/live/robot_messages.h"
#include "plumbline/test/apps/live/simulated_robot.h"
#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/running_program.h"
#include "plumbline/test/core/temp_file.h"
#ifdef PLUMBLINE_LIVE_PEER
#include "plumbline/test/apps/live/peer_process.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// A transform from the map, as the peer prints it.
struct PrintedTransform {
  double stamp_s = 0.0;
  std::string child;
  double x = 0.0, y = 0.0, qz = 0.0, qw = 0.0;
};

std::vector<PrintedTransform> ParseTransforms(const std::string& text) {
  std::istringstream stream(text);
  std::size_t count = 0;
  stream >> count;
  std::vector<PrintedTransform> transforms(count);
  for (PrintedTransform& t : transforms) {
    std::string bar;
    stream >> bar >> t.stamp_s >> t.child >> t.x >> t.y >> t.qz >> t.qw;
  }
  EXPECT_TRUE(stream) << text;
  return transforms;
}

// The map as the peer prints it.
std::string MapText(const LiveMap& map) {
  std::string cells;
  for (const Occupancy cell : map.grid.cells) {
    cells += static_cast<char>(cell == Occupancy::kOccupied ? 100
                               : cell == Occupancy::kFree   ? 0
                                                            : -1);
  }
  std::ostringstream text;
  text << std::setprecision(17) << map.stamp_s << " map "
       << static_cast<float>(map.grid.resolution_m) << ' ' << map.grid.width << ' '
       << map.grid.height << ' ' << map.grid.left_m << ' ' << map.grid.bottom_m << ' '
       << cells.size() << ' ' << HashOf(cells);
  return text.str();
}

// A node that is given the same messages in this process.
class Reference {
 public:
  Reference() : node_(Options()) {}

  static LiveOptions Options() {
    LiveOptions options;
    options.wait_for_background = true;
    return options;
  }
  void Drive(const SimulatedRobot& robot, int first, int last) {
    node_.AddTransforms(robot.StaticTransforms());
    for (int i = first; i < last; ++i) {
      node_.AddTransforms(robot.OdometryTransform(i));
      node_.AddScan(robot.Scan(i), 0.0);
      node_.Work(0.0, &updates_);
    }
  }
  void PlayBag(const std::string& path, bool without_odometry) {
    std::vector<RecordedMessage> messages;
    const Status status = ReadMessagesOfRobot(path, &messages);
    ASSERT_TRUE(status.ok()) << status.message();
    std::string fault;
    // Scans alone wait for no odometry here.
    if (without_odometry) now_s_ = 10.0;
    for (const RecordedMessage& message : messages) {
      std::vector<RosTransform> transforms;
      RosScan scan;
      if (message.topic == "/scan") {
        ASSERT_TRUE(DecodeScan(RosEncoding::kCdr, message.bytes, &scan, &fault)) << fault;
        node_.AddScan(scan, 0.0);
      } else if (message.topic == "/tf_static" || (message.topic == "/tf" && !without_odometry)) {
        ASSERT_TRUE(DecodeTransforms(RosEncoding::kCdr, message.bytes, &transforms, &fault));
        node_.AddTransforms(transforms);
      }
      node_.Work(now_s_, &updates_);
    }
    now_s_ = 10.0;
    node_.Work(now_s_, &updates_);
  }
  void ExpectSame(const std::vector<PrintedTransform>& transforms) const {
    ASSERT_EQ(transforms.size(), updates_.size());
    for (std::size_t i = 0; i < transforms.size(); ++i) {
      const LiveUpdate& update = updates_[i];
      EXPECT_NEAR(transforms[i].stamp_s, update.stamp_s + 0.2, 1e-6);
      ASSERT_EQ(transforms[i].child, update.child_frame);
      ASSERT_EQ(transforms[i].x, update.map_from_child.x) << i;
      ASSERT_EQ(transforms[i].y, update.map_from_child.y) << i;
      EXPECT_NEAR(transforms[i].qz, std::sin(0.5 * update.map_from_child.yaw), 1e-12);
      EXPECT_NEAR(transforms[i].qw, std::cos(0.5 * update.map_from_child.yaw), 1e-12);
    }
  }
  std::string Map() {
    LiveMap map;
    EXPECT_TRUE(node_.BuildMap(&map).ok());
    return MapText(map);
  }
  Status Save(const std::string& folder) {
    MappedDrive drive;
    PLUMBLINE_RETURN_IF_ERROR(node_.MapNow(&drive));
    return SaveLiveMap(LiveOptions().mapper.map, LiveOptions().resolution_m, folder,
                       std::move(drive));
  }
  const std::vector<LiveUpdate>& updates() const { return updates_; }

 private:
  LiveNode node_;
  std::vector<LiveUpdate> updates_;
  double now_s_ = 0.0;
};

const SimulatedRobot& LiveRobot() {
  static const SimulatedRobot robot;
  return robot;
}

class LiveProgramTest : public ProgramTest {
 protected:
  static std::string Flags(int domain) {
    return "--network_interface=lo --domain=" + std::to_string(domain);
  }
  // Starts the program and waits until it listens.
  std::unique_ptr<RunningProgram> Start(int domain, const std::vector<std::string>& flags = {}) {
    std::vector<std::string> command = {std::string(PLUMBLINE_PROGRAMS_DIR) + "/plumbline_live",
                                        "--network_interface=lo",
                                        "--domain=" + std::to_string(domain),
                                        "--map_update_interval_s=0.2", "--wait_for_background"};
    command.insert(command.end(), flags.begin(), flags.end());
    auto program = std::make_unique<RunningProgram>(command, Log(domain));
    EXPECT_TRUE(program->Prints("Listening")) << ReadFile(Log(domain));
    return program;
  }
  std::string Log(int domain) const { return folder_ + std::to_string(domain) + ".log"; }

  // Asks until the answer is as expected, or 10 s have passed; returns the last answer.
  static std::string AskUntil(PeerProcess* peer, const std::string& question,
                              const testing::Matcher<std::string>& expected) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (true) {
      std::string answer = peer->Ask(question);
      if (expected.Matches(answer) || std::chrono::steady_clock::now() > end) return answer;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  static int End(RunningProgram* program) {
    program->Send(SIGINT);
    return program->Wait();
  }
};

TEST_F(LiveProgramTest, MapsLikeTheNodeInProcess) {
  constexpr int kNumScans = 120;
  const int domain = FreeDomain();
  const auto program = Start(domain);
  PeerProcess peer(domain);
  ASSERT_EQ(peer.Ask("find"), "found");
  EXPECT_THAT(peer.Ask("drive 0 " + std::to_string(kNumScans)), StartsWith("120 scans"));
  Reference reference;
  reference.Drive(LiveRobot(), 0, kNumScans);
  reference.ExpectSame(ParseTransforms(peer.Ask("transforms")));
  const std::string map = reference.Map();
  EXPECT_EQ(AskUntil(&peer, "map", map), map);
  EXPECT_EQ(peer.Ask("late_map"), map);
  EXPECT_THAT(AskUntil(&peer, "diagnostics", HasSubstr("scans mapped = 120")),
              AllOf(HasSubstr("level=0 plumbline_live: map: mapping"),
                    HasSubstr("scans received = 120; scans mapped = 120")));
  EXPECT_EQ(End(program.get()), 128 + SIGINT);
  EXPECT_THAT(ReadFile(Log(domain)), HasSubstr("120 scans received, 120 mapped"));
}

TEST_F(LiveProgramTest, TakesTheTurtleBotsBag) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "PLUMBLINE_DATASETS is not set";
  const std::string bag = DatasetsFolder() + "/ecosystem/turtlebot4_floor.db3";
  for (const bool without_odometry : {false, true}) {
    const int domain = FreeDomain();
    const auto program = Start(domain);
    PeerProcess peer(domain);
    ASSERT_EQ(peer.Ask("find"), "found");
    const std::string played =
        peer.Ask("bag " + bag + (without_odometry ? " without_odometry" : ""));
    EXPECT_THAT(played, StartsWith("357 scans"));
    Reference reference;
    reference.PlayBag(bag, without_odometry);
    EXPECT_GT(reference.updates().size(), 300u);
    reference.ExpectSame(ParseTransforms(peer.Ask("transforms")));
    const std::string map = reference.Map();
    EXPECT_EQ(AskUntil(&peer, "map", map), map);
  }
}

TEST_F(LiveProgramTest, GoesOnWithAPlayerThatRestarts) {
  const int domain = FreeDomain();
  const auto program = Start(domain);
  Reference reference;
  for (const int first : {0, 30}) {
    PeerProcess peer(domain);
    ASSERT_EQ(peer.Ask("find"), "found");
    EXPECT_THAT(peer.Ask("drive " + std::to_string(first) + " " + std::to_string(first + 30)),
                StartsWith("30 scans"));
    const std::size_t num_before = reference.updates().size();
    reference.Drive(LiveRobot(), first, first + 30);
    const auto transforms = ParseTransforms(peer.Ask("transforms"));
    ASSERT_GE(transforms.size(), 30u);  // reliable writers may repeat earlier ones
    EXPECT_EQ(transforms.back().x, reference.updates().back().map_from_child.x);
    EXPECT_EQ(reference.updates().size(), num_before + 30);
    const std::string map = reference.Map();
    EXPECT_EQ(AskUntil(&peer, "map", map), map);
  }
}

TEST_F(LiveProgramTest, KeepsDomainsAndNameSpacesApart) {
  const int first_domain = FreeDomain(), second_domain = FreeDomain();
  ASSERT_NE(first_domain, second_domain);
  const auto first = Start(first_domain, {"--namespace=/robot1"});
  const auto second = Start(second_domain);
  PeerProcess first_peer(first_domain, "/robot1"), second_peer(second_domain);
  ASSERT_EQ(first_peer.Ask("find"), "found");
  ASSERT_EQ(second_peer.Ask("find"), "found");
  EXPECT_THAT(first_peer.Ask("drive 0 20"), StartsWith("20 scans"));
  EXPECT_THAT(second_peer.Ask("drive 40 65"), StartsWith("25 scans"));
  Reference of_first, of_second;
  of_first.Drive(LiveRobot(), 0, 20);
  of_second.Drive(LiveRobot(), 40, 65);
  of_first.ExpectSame(ParseTransforms(first_peer.Ask("transforms")));
  of_second.ExpectSame(ParseTransforms(second_peer.Ask("transforms")));
  EXPECT_NE(of_first.Map(), of_second.Map());
  EXPECT_EQ(AskUntil(&first_peer, "map", of_first.Map()), of_first.Map());
  EXPECT_EQ(AskUntil(&second_peer, "map", of_second.Map()), of_second.Map());
}

TEST_F(LiveProgramTest, GoesOnAfterBadMessages) {
  const int domain = FreeDomain();
  const auto program = Start(domain);
  PeerProcess peer(domain);
  ASSERT_EQ(peer.Ask("find"), "found");
  EXPECT_THAT(peer.Ask("drive 0 10"), StartsWith("10 scans"));
  for (const char* kind : {"nan", "short", "noise", "transform"}) {
    for (int i = 0; i < 2; ++i) EXPECT_EQ(peer.Ask(std::string("bad ") + kind), "sent");
  }
  EXPECT_THAT(AskUntil(&peer, "diagnostics", HasSubstr("transforms of no use = 2")),
              AllOf(HasSubstr("scans that are no sweep of a laser = 2"),
                    HasSubstr("messages on scan that cannot be decoded = 4"),
                    HasSubstr("transforms of no use = 2")));
  // Best effort: not every message of half a megabyte arrives.
  std::string diagnostics;
  for (int i = 0; i < 10 && diagnostics.find("no sweep of a laser = 3") == diagnostics.npos; ++i) {
    EXPECT_EQ(peer.Ask("bad huge"), "sent");
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    diagnostics = peer.Ask("diagnostics");
  }
  EXPECT_THAT(diagnostics, HasSubstr("no sweep of a laser = 3"));
  EXPECT_THAT(peer.Ask("drive 10 20"), StartsWith("10 scans"));
  EXPECT_EQ(peer.Ask("bad flood"), "sent");
  EXPECT_THAT(AskUntil(&peer, "diagnostics", HasSubstr("scans too soon after")),
              HasSubstr("scans too soon after the one before"));
  EXPECT_EQ(End(program.get()), 128 + SIGINT);
  // Each kind is told once.
  const std::string log = ReadFile(Log(domain));
  for (const char* kind : {"scans that are no sweep of a laser: ", "cannot be decoded: ",
                           "transforms of no use: ", "scans too soon after the one before: "}) {
    const std::size_t first = log.find(kind);
    EXPECT_NE(first, log.npos) << kind;
    EXPECT_EQ(log.find(kind, first + 1), log.npos) << kind;
  }
}

TEST_F(LiveProgramTest, ServesItsOwnClientAndAForeignOne) {
  const int domain = FreeDomain();
  const std::string flags = Flags(domain);
  ExpectUsageError(Run("live", flags + " --call=dance"), "'dance' is none of save_map, ");
  ExpectUsageError(Run("live", flags + " --call=save_map"), "save_map needs a value");
  ExpectUsageError(Run("live", flags + " --call=clear=all"), "clear has no value");
  ExpectError(Run("live", flags + " --call=clear --call_timeout_s=0.3"),
              "no live program answers to /plumbline/clear", kExitCannotWrite);
  const auto program = Start(domain);
  PeerProcess peer(domain);
  ASSERT_EQ(peer.Ask("find"), "found");
  EXPECT_THAT(peer.Ask("drive 0 10"), StartsWith("10 scans"));
  const Outcome paused = Run("live", flags + " --call=pause");
  EXPECT_EQ(paused.exit_code, 0) << paused.err;
  EXPECT_EQ(paused.out, "paused\n");
  EXPECT_THAT(AskUntil(&peer, "diagnostics", HasSubstr("map: paused")), HasSubstr("map: paused"));
  EXPECT_EQ(Run("live", flags + " --call=resume").out, "resumed\n");
  EXPECT_EQ(peer.Ask("call clear std_srvs::srv::dds_::Trigger"),
            "success: the next scan begins a new map");
  EXPECT_THAT(peer.Ask("drive 10 20"), StartsWith("10 scans"));
  const std::string expected = "scans received = 20; scans mapped = 10";
  EXPECT_THAT(AskUntil(&peer, "diagnostics", HasSubstr(expected)), HasSubstr(expected));
}

TEST_F(LiveProgramTest, SavesTheMapOfABatchRun) {
  const int domain = FreeDomain();
  const std::string flags = Flags(domain);
  const auto program = Start(domain);
  PeerProcess peer(domain);
  ASSERT_EQ(peer.Ask("find"), "found");
  ExpectError(Run("live", flags + " --call=save_map=" + folder_ + "out"), "there are no scans yet",
              kExitCannotWrite);
  EXPECT_THAT(peer.Ask("drive 0 60"), StartsWith("60 scans"));
  const Outcome saved = Run("live", flags + " --call=save_map=" + folder_ + "out");
  ASSERT_EQ(saved.exit_code, 0) << saved.err;
  EXPECT_THAT(saved.out, HasSubstr("saved the map of 60 scans in "));
  std::vector<std::string> expected = kResults;
  expected.push_back("map.g2o");
  EXPECT_THAT(FilesOf("out"), testing::UnorderedElementsAreArray(expected));
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out.saving"));

  Reference reference;
  reference.Drive(LiveRobot(), 0, 60);
  ASSERT_TRUE(reference.Save(folder_ + "here").ok());
  for (const std::string& name : expected) {
    if (name == "report.html" || name == "summary.json") continue;  // with times of the run
    EXPECT_EQ(HashOf(Result("out", name)), HashOf(Result("here", name))) << name;
  }

  // A later map replaces it at once, but no other files.
  EXPECT_THAT(peer.Ask("drive 60 70"), StartsWith("10 scans"));
  const std::string name = folder_ + "out/";
  EXPECT_EQ(peer.Ask("call save_map diagnostic_msgs::srv::dds_::AddDiagnostics " + name),
            "success: saved the map of 70 scans in " + name);
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 70u);
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out.saving"));
  WriteFile(folder_ + "out/notes.txt", "mine");
  EXPECT_THAT(Run("live", flags + " --call=save_map=" + folder_ + "out").err,
              HasSubstr("holds other files than a map: notes.txt"));
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 70u);
}

TEST_F(LiveProgramTest, LocalisesInASavedMap) {
  Reference reference;
  reference.Drive(LiveRobot(), 0, 120);
  ASSERT_TRUE(reference.Save(folder_ + "map").ok());
  const int domain = FreeDomain();
  const std::string flags = Flags(domain);
  const auto program = Start(domain);
  PeerProcess peer(domain);
  ASSERT_EQ(peer.Ask("find"), "found");
  ExpectError(Run("live", flags + " --call=localize=" + folder_ + "map/map.pgm"),
              "no pose graph with scans", kExitCannotWrite);
  EXPECT_EQ(Run("live", flags + " --call=localize=" + folder_ + "map/map.g2o").out,
            "localising in a map of 120 scans\n");
  EXPECT_EQ(peer.Ask("stream 20 90"), "sent");
  EXPECT_THAT(AskUntil(&peer, "diagnostics", HasSubstr("scans mapped = 70")),
              HasSubstr("map: localising"));
  const auto transforms = ParseTransforms(peer.Ask("transforms"));
  ASSERT_GT(transforms.size(), 5u);
  const PrintedTransform& last = transforms.back();
  EXPECT_EQ(last.child, "odom");
  const Pose2 odometry = LiveRobot().log().scans[89].odom_from_robot;
  const Pose2 pose = Pose2(last.x, last.y, 2.0 * std::atan2(last.qz, last.qw)) * odometry;
  const Pose2 truth = Between(LiveRobot().log().scans[0].world_from_robot,
                              LiveRobot().log().scans[89].world_from_robot);
  EXPECT_LT((pose.translation() - truth.translation()).norm(), 0.15);
}

TEST_F(LiveProgramTest, RefusesFlagsThatMakeNoSense) {
  ExpectUsageError(Run("live", "--domain=300"), "domain = 300");
  ExpectUsageError(Run("live", "--resolution=0"), "resolution_m = 0");
  ExpectUsageError(Run("live", "--localize"), "--localize needs a --map");
  ExpectError(Run("live", "--network_interface=no_such_one --domain=12"),
              "no_such_one: does not match", kExitCannotWrite);
}

}  // namespace
}  // namespace plumbline
#else
namespace plumbline {
namespace {

TEST(LiveProgramTest, MapsLikeTheNodeInProcess) {
  GTEST_SKIP() << "Cyclone DDS or Fast DDS is not installed";
}

}  // namespace
}  // namespace plumbline
#endif
