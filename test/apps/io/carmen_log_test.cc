#include "plumbline/apps/io/carmen_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const char kGoodScan[] = "FLASER 2 1.5 2.5 0.1 0.2 0.3 1 2 3 10 host 0.5\n";

/// A scan of one line with these ranges at a time.
std::string Flaser(const std::vector<double>& ranges, double timestamp_s = 0.0) {
  std::string line = "FLASER " + std::to_string(ranges.size());
  for (double range_m : ranges) line += " " + std::to_string(range_m);
  return line + " 0 0 0 0 0 0 " + std::to_string(timestamp_s) + " host 0\n";
}

class CarmenLogTest : public testing::Test {
 protected:
  Status Read(const std::string& content) {
    WriteFile(path_, content);
    return ReadCarmenLog(path_, options_, &log_);
  }

  /// Maximum range that the reader settles on for a log of one scan, after `params`.
  double MaxRange(const std::vector<double>& ranges, const std::string& params = "") {
    const Status status = Read(params + Flaser(ranges));
    EXPECT_TRUE(status.ok()) << status.message();
    return log_.scans.at(0).max_range_m;
  }

  const std::string path_ = TempFolder() + "a.clf";
  CarmenReadOptions options_;
  CarmenLog log_;
};

TEST_F(CarmenLogTest, ReadsFlaser) {
  ASSERT_TRUE(Read("# comment\n\nFLASER 4 1.5 2.5 nan 81.9 0.1 0.2 0.3 1 2 -3 976052857.337530 "
                   "host 0.5\r\nNEFF 12\nRLASER nonsense\n")
                  .ok());
  ASSERT_EQ(log_.scans.size(), 1u);
  EXPECT_EQ(log_.num_records, 1u);
  EXPECT_EQ(log_.num_issues, 0u);
  const CarmenScan& scan = log_.scans[0];
  EXPECT_EQ(scan.line, 3u);
  EXPECT_EQ(scan.timestamp_s, 976052857.337530);
  EXPECT_EQ(scan.odom_from_laser.x, 0.1);
  EXPECT_EQ(scan.odom_from_laser.y, 0.2);
  EXPECT_EQ(scan.odom_from_laser.yaw, 0.3);
  EXPECT_EQ(scan.odom_from_robot.x, 1.0);
  EXPECT_EQ(scan.odom_from_robot.y, 2.0);
  EXPECT_EQ(scan.odom_from_robot.yaw, -3.0);
  ASSERT_EQ(scan.ranges.size(), 4u);
  EXPECT_EQ(scan.ranges[1], 2.5);
  EXPECT_TRUE(std::isnan(scan.ranges[2]));
}

TEST_F(CarmenLogTest, FlaserBearingsDependOnWhetherTheNumberOfBeamsIsOdd) {
  const std::vector<std::pair<int, double>> steps_deg = {{2, 90.0},  {180, 1.0}, {181, 1.0},
                                                         {360, 0.5}, {361, 0.5}, {721, 0.25}};
  for (const auto& [num_beams, step_deg] : steps_deg) {
    ASSERT_TRUE(Read(Flaser(std::vector<double>(num_beams, 1.0))).ok());
    EXPECT_NEAR(RadToDeg(log_.scans[0].first_bearing_rad), -90.0, 1e-12);
    EXPECT_NEAR(RadToDeg(log_.scans[0].bearing_step_rad), step_deg, 1e-12);
  }
  ASSERT_TRUE(Read(Flaser({1.0})).ok());
  EXPECT_TRUE(std::isfinite(log_.scans[0].bearing_step_rad));
}

TEST_F(CarmenLogTest, FlaserOfCertainLasersOrOnDemandCoversMore) {
  const auto expect = [&](int num_beams, double first_deg, double step_deg) {
    ASSERT_TRUE(Read(Flaser(std::vector<double>(num_beams, 1.0))).ok());
    EXPECT_TRUE(log_.scans[0].is_flaser);
    EXPECT_NEAR(RadToDeg(log_.scans[0].first_bearing_rad), first_deg, 1e-12);
    EXPECT_NEAR(RadToDeg(log_.scans[0].bearing_step_rad), step_deg, 1e-12);
  };
  expect(541, -135.0, 0.5);
  expect(1081, -135.0, 0.25);
  options_.flaser_fov_rad = DegToRad(240.0);
  expect(481, -120.0, 0.5);
  expect(541, -120.0, 240.0 / 540.0);
  options_.flaser_fov_rad = DegToRad(360.0);
  expect(360, -180.0, 1.0);
}

TEST_F(CarmenLogTest, ALogOfRawScansSaysWhatIsMissing) {
  const Status status = Read("RAWLASER1 0 -1.57 3.14 0.0174 81 0.01 0 2 1 2 0 1.0 host 1.0\n");
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(),
              HasSubstr("its 1 scans are RAWLASER records, which do not say where the robot was; "
                        "write each as FLASER"));
}

TEST_F(CarmenLogTest, ReadsRobotLaserWithItsOwnGeometry) {
  ASSERT_TRUE(Read("PARAM robot_front_laser_max 30 host 0\n"
                   "ROBOTLASER1 4 -2.0 4.0 0.5 49.5 0.01 1 3 1.0 2.0 3.0 2 100 200 "
                   "1.1 1.2 1.3 2.1 2.2 2.3 0.4 0.5 0.6 0.7 0.8 12.25 host 0.1\n")
                  .ok());
  ASSERT_EQ(log_.scans.size(), 1u);
  const CarmenScan& scan = log_.scans[0];
  EXPECT_EQ(scan.first_bearing_rad, -2.0);
  EXPECT_EQ(scan.bearing_step_rad, 0.5);
  EXPECT_EQ(scan.max_range_m, 49.5);
  EXPECT_THAT(scan.ranges, ElementsAre(1.0, 2.0, 3.0));
  EXPECT_EQ(scan.odom_from_laser.x, 1.1);
  EXPECT_EQ(scan.odom_from_robot.yaw, 2.3);
  EXPECT_EQ(scan.timestamp_s, 12.25);
}

TEST_F(CarmenLogTest, ReadsParametersAndCountsOdometry) {
  ASSERT_TRUE(Read(std::string("PARAM robot_frontlaser_offset 0.3 1 merci 1\n"
                               "PARAM robot_frontlaser_offset -0.04 2 merci 2\n"
                               "PARAM robot_use_laser on 1 merci 1\n"
                               "ODOM 1 2 3 0.4 0.5 0.6 7.5 host 8\n") +
                   kGoodScan)
                  .ok());
  EXPECT_EQ(log_.params.at("robot_frontlaser_offset"), "-0.04");
  EXPECT_EQ(log_.params.at("robot_use_laser"), "on");
  EXPECT_EQ(log_.num_records, 5u);
}

TEST_F(CarmenLogTest, BadRecordsAreNamedCountedAndSkipped) {
  const std::vector<std::vector<std::string>> cases = {
      {"FLASER 2 1 2 0 0 0 abc 0 0 10 host 0", "FLASER field 'odom_x': 'abc' is not a number"},
      {"FLASER 2 1 2 0 nan 0 0 0 0 10 host 0",
       "FLASER field 'laser_y': 'nan' is not a finite number"},
      {"FLASER 2 1 2 0 0 0 0 0 0 inf host 0",
       "FLASER field 'ipc_timestamp': 'inf' is not a finite number"},
      {"FLASER -2 0 0 0 0 0 0 10 host 0", "FLASER field 'num_readings': '-2' is not a count"},
      {"FLASER 0 0 0 0 0 0 0 10 host 0",
       "FLASER field 'num_readings': a scan needs at least one beam"},
      {"FLASER 3 1 2 0 0 0 0 0 0 10 host 0",
       "FLASER field 'ipc_timestamp': 'host' is not a number"},
      {"FLASER 1 1 2 0 0 0 0 0 0 10 host 0",
       "FLASER field 'logger_timestamp': 'host' is not a number"},
      {"FLASER 2 1 x 0 0 0 0 0 0 10 host 0", "FLASER field 'range[1]': 'x' is not a number"},
      {"FLASER 2 1 2 0 0 0 0 0 0 10 host 0 1",
       "FLASER field 'end of line': '1' is one field too many"},
      {"FLASER 360 1.0 1.1", "FLASER field 'range[2]': is missing, the line ends before it"},
      {"ROBOTLASER1 0 -1.5 3 0 80 0 0 1 1 0 0 0 0 0 0 0 0 0 0 0 0 0 10 host 0",
       "ROBOTLASER1 field 'angular_resolution': '0' is not a positive number"},
      {"ODOM 1 2 3 0 0 0 ten host 8", "ODOM field 'ipc_timestamp': 'ten' is not a number"},
      {"PARAM robot_front_laser_max none host 0", "PARAM field 'value': 'none' is not a number"},
      {"PARAM lonely", "PARAM field 'value': is missing, the line ends before it"},
  };
  for (const std::vector<std::string>& c : cases) {
    const Status status = Read(kGoodScan + c[0] + "\n" + kGoodScan);
    ASSERT_TRUE(status.ok()) << status.message();
    EXPECT_EQ(log_.scans.size(), 2u);
    EXPECT_EQ(log_.num_records, 3u);
    EXPECT_EQ(log_.num_issues, 1u);
    ASSERT_EQ(log_.issues.size(), 1u);
    EXPECT_EQ(log_.issues[0].line, 2u);
    EXPECT_EQ(log_.issues[0].message, path_ + ":2: " + c[1]);
    EXPECT_THAT(c[1], HasSubstr("field '" + log_.issues[0].field + "'"));
  }
}

TEST_F(CarmenLogTest, ATornLastLineIsAnIssue) {
  ASSERT_TRUE(Read(std::string(kGoodScan) + "FLASER 2 1.5 2.5 0.1 0.2").ok());
  EXPECT_EQ(log_.scans.size(), 1u);
  EXPECT_EQ(log_.num_issues, 1u);
  EXPECT_EQ(log_.issues[0].field, "laser_theta");
}

TEST_F(CarmenLogTest, TooManyBadRecordsAreDataLoss) {
  std::string content = kGoodScan;
  for (int i = 0; i < 10; ++i) content += "ODOM bad\n";
  ASSERT_TRUE(Read(content).ok());
  EXPECT_EQ(log_.num_issues, 10u);

  const Status status = Read(content + "ODOM bad\n");
  EXPECT_EQ(status.code(), StatusCode::kDataLoss);
  EXPECT_THAT(
      status.message(),
      AllOf(HasSubstr(path_ + ": 11 of 12 records are unreadable, more than the 10 allowed"),
            HasSubstr(":2: ODOM field 'x': 'bad' is not a number")));
  EXPECT_EQ(log_.num_issues, 10u);  // Of the log read before.

  options_.bad_records.max_records = 0;
  EXPECT_EQ(Read(content).code(), StatusCode::kDataLoss);
}

TEST_F(CarmenLogTest, ALongLogMayHaveOnePercentOfBadRecords) {
  std::string content;
  for (int i = 0; i < 1980; ++i) content += kGoodScan;
  for (int i = 0; i < 20; ++i) content += "ODOM bad\n";
  ASSERT_TRUE(Read(content).ok());
  EXPECT_EQ(log_.num_issues, 20u);
  EXPECT_EQ(log_.issues.size(), 10u);
  EXPECT_EQ(Read(content + "ODOM bad\n").code(), StatusCode::kDataLoss);
}

TEST_F(CarmenLogTest, SortsByTimeAndKeepsDuplicates) {
  const auto scan = [](double range_m, double timestamp_s) {
    return Flaser({range_m}, timestamp_s);
  };
  ASSERT_TRUE(Read(scan(1, 5) + "ODOM 0 0 0 0 0 0 9 host 0\n" + scan(2, 7) + scan(3, 6) +
                   "ODOM 0 0 0 0 0 0 8 host 0\n" + scan(4, 7) + scan(5, 5))
                  .ok());
  std::vector<double> order;
  for (const CarmenScan& s : log_.scans) order.push_back(s.ranges[0]);
  EXPECT_THAT(order, ElementsAre(1, 5, 3, 2, 4));
  EXPECT_EQ(log_.num_out_of_order, 2u);  // scans 3 and 5
}

TEST_F(CarmenLogTest, AUselessClockSortsNothing) {
  std::string content;
  double range_m = 0.0;
  for (const double time_s : {-0.4, -0.9, 4e9, 4e9, 4e9, 4e9, 4e9}) {
    content += Flaser({++range_m}, time_s);
  }
  ASSERT_TRUE(Read(content).ok());
  std::vector<double> order;
  for (const CarmenScan& s : log_.scans) order.push_back(s.ranges[0]);
  EXPECT_THAT(order, ElementsAre(1, 2, 3, 4, 5, 6, 7));
  EXPECT_EQ(log_.num_out_of_order, 0u);
}

TEST_F(CarmenLogTest, MaxRangeIsTheParameterOr80Metres) {
  EXPECT_EQ(MaxRange({1.0, 2.0, 3.0}), 80.0);
  EXPECT_EQ(MaxRange({1.0, 2.0, 3.0}, "PARAM robot_front_laser_max 30.5 host 0\n"), 30.5);
}

TEST_F(CarmenLogTest, MaxRangeIsBelowTheReadingThatStandsForNoEcho) {
  std::vector<double> ranges;
  for (int i = 0; i < 100; ++i) ranges.push_back(0.3 * i);
  EXPECT_EQ(MaxRange(ranges), 80.0);
  ranges.insert(ranges.end(), 9, 50.0);
  EXPECT_EQ(MaxRange(ranges), 80.0);  // Too few.
  ranges.push_back(50.0);
  EXPECT_NEAR(MaxRange(ranges), 49.95, 1e-9);
  EXPECT_NEAR(MaxRange(ranges, "PARAM robot_front_laser_max 60 host 0\n"), 49.95, 1e-9);
  EXPECT_EQ(MaxRange(ranges, "PARAM robot_front_laser_max 20 host 0\n"), 20.0);
  ranges.push_back(49.9);  // One true reading close below is not enough to doubt it,
  EXPECT_EQ(MaxRange(ranges), 80.0);
  ranges.push_back(50.0);  // as long as the level recurs more than ten times as often.
  EXPECT_NEAR(MaxRange(ranges), 49.95, 1e-9);
}

TEST_F(CarmenLogTest, AllOfSicksErrorCodesAreNoReturns) {
  std::vector<double> ranges = {1.0, 30.0};
  ranges.push_back(81.91);
  ranges.insert(ranges.end(), 20, 81.83);
  const double max_range_m = MaxRange(ranges);
  EXPECT_LT(max_range_m, 81.83);
  EXPECT_GT(max_range_m, 81.8);
}

TEST_F(CarmenLogTest, AFarWallIsNotMistakenForNoEcho) {
  // A wall straight ahead at 20 m, 2 cm of noise: hundreds of readings close to the largest.
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::vector<double> ranges = {1.0};
  for (int i = 0; i < 1000; ++i) ranges.push_back(20.0 + noise(random));
  EXPECT_EQ(MaxRange(ranges), 80.0);
  // One and the same reading everywhere says nothing about what it means.
  EXPECT_EQ(MaxRange(std::vector<double>(180, 4.0)), 80.0);
}

TEST_F(CarmenLogTest, ReadsGzipAndKeepsTheWholeLinesOfATruncatedFile) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> range_m(0.1, 20.0);
  std::string content;
  for (int i = 0; i < 500; ++i) {
    std::vector<double> ranges(180);
    for (double& r : ranges) r = range_m(random);
    content += Flaser(ranges, i);
  }
  ASSERT_TRUE(Read(content).ok());
  const CarmenLog plain = log_;

  gzFile file = gzopen(path_.c_str(), "wb");
  gzwrite(file, content.data(), content.size());
  gzclose(file);
  ASSERT_TRUE(ReadCarmenLog(path_, options_, &log_).ok());
  ASSERT_EQ(log_.scans.size(), 500u);
  EXPECT_EQ(log_.num_issues, 0u);
  EXPECT_EQ(log_.scans[499].ranges, plain.scans[499].ranges);

  const std::string compressed = ReadFile(path_);
  ASSERT_TRUE(Read(compressed.substr(0, compressed.size() / 2)).ok());
  EXPECT_GT(log_.scans.size(), 200u);
  ASSERT_LT(log_.scans.size(), 300u);
  EXPECT_EQ(log_.scans.back().ranges, plain.scans[log_.scans.size() - 1].ranges);
  EXPECT_EQ(log_.num_issues, 1u);
  EXPECT_THAT(log_.issues[0].message, HasSubstr("the compressed file is truncated after line " +
                                                std::to_string(log_.scans.size())));

  std::string corrupt = compressed;
  corrupt[corrupt.size() - 6] ^= 1;
  EXPECT_EQ(Read(corrupt).code(), StatusCode::kDataLoss);
}

TEST_F(CarmenLogTest, FilesWithoutScansAreRefused) {
  const Status empty = Read("# nothing\n");
  EXPECT_EQ(empty.code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(empty.message(), path_ + ": no FLASER or ROBOTLASER1 record, as a CARMEN log has");
  const Status bad = Read("FLASER 1 1 0 0 0 0 0 0 x host 0\n");
  EXPECT_EQ(bad.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(bad.message(), HasSubstr("first issue: " + path_ + ":1: FLASER field"));

  const Status missing = ReadCarmenLog(path_ + ".none", options_, &log_);
  EXPECT_EQ(missing.code(), StatusCode::kNotFound);
  EXPECT_THAT(missing.message(), HasSubstr(path_ + ".none"));
}

TEST_F(CarmenLogTest, OptionsAreChecked) {
  options_.bad_records.max_share = 1.5;
  const Status status = Read(kGoodScan);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("max_share = 1.5"));
}

TEST_F(CarmenLogTest, TakesNoMoreMemoryThanAllowed) {
  const std::string scan = Flaser(std::vector<double>(1000, 1.5), 1.0);
  std::string odometry;
  for (int i = 0; i < 10000; ++i) odometry += "ODOM 0 0 0 0 0 0 9 host 0\n";
  options_.max_bytes = 1e6;
  EXPECT_TRUE(Read(scan + odometry).ok());
  std::string scans, params;
  for (int i = 0; i < 150; ++i) scans += scan;
  const Status status = Read(scans);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(),
              HasSubstr(": what was read so far takes more memory than the 1 MB"));
  for (int i = 0; i < 100000; ++i) params += "PARAM p" + std::to_string(i) + " 1\n";
  EXPECT_THAT(Read(scan + params).message(), HasSubstr("takes more memory"));
}

// Numbers of the files themselves, counted with awk.
TEST(CarmenLogDatasetTest, Fr079) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "set PLUMBLINE_DATASETS to the folder of the logs";
  CarmenLog log;
  const Status status = ReadCarmenLog(DatasetsFolder() + "/fr079.clf.gz", {}, &log);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(log.scans.size(), 4934u);
  EXPECT_EQ(log.num_records, 4934u + 8951u + 187u);
  EXPECT_EQ(log.num_issues, 0u);
  EXPECT_EQ(log.num_out_of_order, 0u);
  EXPECT_EQ(log.scans[0].ranges.size(), 360u);
  EXPECT_NEAR(RadToDeg(log.scans[0].bearing_step_rad), 0.5, 1e-12);
  EXPECT_EQ(log.scans[0].max_range_m, 80.99);
  EXPECT_EQ(log.scans[0].timestamp_s, 1211.520329);
  EXPECT_EQ(log.scans[0].odom_from_robot.x, -3.034287);
}

TEST(CarmenLogDatasetTest, Intel) {
  if (DatasetsFolder().empty()) GTEST_SKIP() << "set PLUMBLINE_DATASETS to the folder of the logs";
  CarmenLog log;
  const Status status = ReadCarmenLog(DatasetsFolder() + "/intel.clf.gz", {}, &log);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(log.scans.size(), 13631u);
  EXPECT_EQ(log.num_issues, 0u);
  EXPECT_EQ(log.num_out_of_order, 631u);
  // 81.83 stands for "no echo", 68,313 times; the largest true reading is 26.37.
  std::size_t num_no_return = 0;
  for (const CarmenScan& scan : log.scans) {
    EXPECT_LT(scan.max_range_m, 81.83);
    EXPECT_GT(scan.max_range_m, 26.37);
    for (double range_m : scan.ranges) num_no_return += range_m >= scan.max_range_m;
  }
  EXPECT_EQ(num_no_return, 68313u);
}

}  // namespace
}  // namespace plumbline
