// Bags with MultiEchoLaserScan or PointCloud2 give the map of the same drive with LaserScan.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/simulation/building_reader.h"
#include "plumbline/apps/simulation/simulator.h"
#include "plumbline/core/angle.h"
#include "plumbline/test/apps/bags/bag_testing.h"
#include "plumbline/test/apps/bags/ros1_writer.h"
#include "plumbline/test/apps/bags/scan_message_testing.h"
#include "plumbline/test/apps/bags/sqlite_writer.h"
#include "plumbline/test/apps/program_testing.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

using Points = std::vector<std::array<double, 3>>;

class ScanTypesTest : public ProgramTest {
 protected:
  static constexpr int kNumScans = 100;
  static constexpr double kLaserHeightM = 0.5;

  ScanTypesTest() {
    Building building;
    EXPECT_TRUE(ReadBuilding(PLUMBLINE_WORLD, &building).ok());
    SimulationOptions options;
    options.laser.robot_from_laser = {0.1, 0.0, 0.2};
    options.laser.max_range_m = 20.0;
    EXPECT_TRUE(Simulate(World(building), options, &log_).ok());
    log_.scans.resize(kNumScans);
  }

  // A bag of the drive. content: the bytes of a message with these readings.
  template <typename Content>
  TestBag Drive(TestEncoding encoding, const std::string& type, const Content& content) const {
    const std::string infix = encoding == TestEncoding::kRos1 ? "/" : "/msg/";
    TestBag bag;
    bag.push_back({"/tf_static", "tf2_msgs" + infix + "TFMessage", NameOf(encoding), kStart_ns,
                   TransformBytes(encoding, 0, "base_link", "laser", log_.laser.robot_from_laser)});
    for (const SimulatedScan& scan : log_.scans) {
      const std::int64_t stamp_ns = kStart_ns + std::llround(1e9 * scan.scan.timestamp_s);
      bag.push_back({"/odom", "nav_msgs" + infix + "Odometry", NameOf(encoding), stamp_ns,
                     OdometryBytes(encoding, stamp_ns, scan.odom_from_robot)});
      bag.push_back({"/laser", "sensor_msgs" + infix + type, NameOf(encoding), stamp_ns,
                     content(encoding, stamp_ns, scan.scan.ranges)});
    }
    return bag;
  }
  TestBag PlainDrive() const {
    return Drive(TestEncoding::kCdr, "LaserScan",
                 [this](auto encoding, auto stamp_ns, auto& ranges) {
                   return ScanBytes(encoding, stamp_ns, ranges, log_.laser);
                 });
  }
  // Each beam has a second echo behind the first, which is the stronger one.
  TestBag MultiEchoDrive(TestEncoding encoding, bool strongest_first) const {
    return Drive(encoding, "MultiEchoLaserScan", [=](auto e, auto stamp_ns, auto& ranges) {
      std::vector<std::vector<double>> echoes, intensities;
      for (const double range : ranges) {
        const bool is_return = log_.laser.IsReturn(range);
        const double other = strongest_first ? range + 1.0 : 0.5 * range;
        echoes.push_back(!is_return        ? std::vector<double>{}
                         : strongest_first ? std::vector<double>{range, other}
                                           : std::vector<double>{other, range});
        intensities.push_back(!is_return        ? std::vector<double>{}
                              : strongest_first ? std::vector<double>{90, 20}
                                                : std::vector<double>{20, 90});
      }
      return MultiEchoBytes(e, stamp_ns, echoes, intensities, log_.laser);
    });
  }
  // As points: of one ring, or of 16 rings of a 3D laser that see the floor, too.
  TestBag CloudDrive(TestEncoding encoding, bool is_planar, const CloudLayout& layout) const {
    return Drive(encoding, "PointCloud2", [=](auto e, auto stamp_ns, auto& ranges) {
      Points points;
      for (std::size_t i = 0; i < ranges.size(); ++i) {
        if (!log_.laser.IsReturn(ranges[i])) continue;
        for (int ring = 0; ring < (is_planar ? 1 : 16); ++ring) {
          const double slope = is_planar ? 0.0 : std::tan(DegToRad(2.0 * ring - 15.0));
          const double floor_m = slope < 0.0 ? -kLaserHeightM / slope : 1e9;
          const double range = std::min(ranges[i], floor_m);
          const double bearing = log_.laser.Bearing(static_cast<int>(i));
          points.push_back({range * std::cos(bearing), range * std::sin(bearing), range * slope});
        }
      }
      return CloudBytes(e, stamp_ns, "laser", points, layout);
    });
  }

  std::vector<Eigen::Vector2d> Map(const std::string& bag, const std::string& flags = "") const {
    const Outcome run = Slam(bag, flags + " --picture_side_px=200");
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.err, IsEmpty());
    std::vector<Eigen::Vector2d> positions;
    for (const std::string& line : Lines(Result("out", "trajectory.tum"))) {
      std::istringstream fields(line);
      double stamp_s = 0.0;
      Eigen::Vector2d position;
      fields >> stamp_s >> position.x() >> position.y();
      positions.push_back(position);
    }
    EXPECT_EQ(positions.size(), static_cast<std::size_t>(kNumScans));
    return positions;
  }

  void ExpectNear(const std::vector<Eigen::Vector2d>& positions,
                  const std::vector<Eigen::Vector2d>& expected, double most_m) const {
    ASSERT_EQ(positions.size(), expected.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
      EXPECT_LT((positions[i] - expected[i]).norm(), most_m) << i;
    }
  }

  SimulatedLog log_;
};

TEST_F(ScanTypesTest, EitherEchoOfMultiEchoScansGivesTheSameMap) {
  WriteSqliteBag(folder_ + "plain.db3", PlainDrive());
  Map("plain.db3");
  const std::string expected = Result("out", "trajectory.tum");
  WriteSqliteBag(folder_ + "first.db3", MultiEchoDrive(TestEncoding::kCdr, true));
  Map("first.db3");
  EXPECT_EQ(Result("out", "trajectory.tum"), expected);
  Map("first.db3", "--echo=strongest");
  EXPECT_EQ(Result("out", "trajectory.tum"), expected);
  WriteFile(folder_ + "last.bag", Ros1Bytes(MultiEchoDrive(TestEncoding::kRos1, false)));
  Map("last.bag", "--echo=strongest");
  EXPECT_EQ(Result("out", "trajectory.tum"), expected);
}

TEST_F(ScanTypesTest, CloudsOfAPlanarLaserGiveTheSameMap) {
  WriteSqliteBag(folder_ + "plain.db3", PlainDrive());
  const std::vector<Eigen::Vector2d> expected = Map("plain.db3");
  WriteSqliteBag(folder_ + "a.db3", CloudDrive(TestEncoding::kCdr, true, PlanarLayout()));
  ExpectNear(Map("a.db3"), expected, 0.003);
  WriteFile(folder_ + "a.bag", Ros1Bytes(CloudDrive(TestEncoding::kRos1, true, PlanarLayout())));
  ExpectNear(Map("a.bag"), expected, 0.003);
}

TEST_F(ScanTypesTest, ABandOfCloudsOfA3dLaserGivesTheSameMap) {
  WriteFile(folder_ + "a.bag",
            Ros1Bytes(CloudDrive(TestEncoding::kRos1, false, VelodyneLayout()), {"lz4", 20, true}));
  ExpectError(Slam("a.bag"),
              "/laser message 0 (1500000000.000000 s): it has points at heights from -0.5 to ");
  ExpectError(Slam("a.bag", "--slice_height_m=50,60"), "no scan has a return");
  WriteSqliteBag(folder_ + "plain.db3", PlainDrive());
  const std::vector<Eigen::Vector2d> expected = Map("plain.db3");
  ExpectNear(Map("a.bag", "--slice_height_m=-0.3,0.3"), expected, 0.005);
  CloudLayout rows = OusterLayout();
  rows.height = 16;
  WriteSqliteBag(folder_ + "a.db3", CloudDrive(TestEncoding::kCdr, false, rows));
  ExpectNear(Map("a.db3", "--slice_height_m=-0.3,0.3"), expected, 0.005);
}

TEST_F(ScanTypesTest, LaserScansComeBeforeOtherTypes) {
  TestBag bag = PlainDrive();
  for (TestMessage message : CloudDrive(TestEncoding::kCdr, true, PlanarLayout())) {
    if (message.topic != "/laser") continue;
    message.topic = "/cloud";
    bag.push_back(message);
  }
  WriteSqliteBag(folder_ + "a.db3", bag);
  ExpectError(Slam("a.db3", "--scan_topic=/odom"),
              "/odom is not of type sensor_msgs/LaserScan, MultiEchoLaserScan or PointCloud2");
  const std::vector<Eigen::Vector2d> expected = Map("a.db3");
  ExpectNear(Map("a.db3", "--scan_topic=/cloud"), expected, 0.003);
}

TEST_F(ScanTypesTest, WrongFlagsAreRefused) {
  WriteSqliteBag(folder_ + "a.db3", PlainDrive());
  for (const std::string flag : {"--echo=last", "--slice_height_m=1", "--slice_height_m=1,0",
                                 "--slice_height_m=0,1,2", "--slice_height_m=nan,1"}) {
    EXPECT_EQ(Slam("a.db3", flag).exit_code, kExitWrongUsage) << flag;
  }
}

}  // namespace
}  // namespace plumbline
