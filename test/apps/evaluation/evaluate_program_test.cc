// What plumbline_evaluate does between its flags and its files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "plumbline/apps/evaluation/evaluation.h"
#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/apps/io/ply_writer.h"
#include "plumbline/apps/report/evaluation_report.h"
#include "plumbline/core/angle.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/test/core/temp_file.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class EvaluateProgramTest : public testing::Test {
 protected:
  // Three scans of a round room of 2 m radius from its centre, where the robot stands still.
  void WriteLog() const {
    std::string text;
    for (int scan = 0; scan < 3; ++scan) {
      text += "FLASER 181";
      for (int beam = 0; beam < 181; ++beam) text += " 2.0";
      text += " 0 0 0 0 0 0 " + std::to_string(scan) + ".5 host 0\n";
    }
    WriteFile(Path("a.clf"), text);
  }
  // Its poses, the last one `shift` to the front; "" leaves it out.
  void WriteTrajectory(const std::string& shift) const {
    std::string text = "0.5 0 0 0 0 0 0 1\n1.5 0 0 0 0 0 0 1\n";
    if (!shift.empty()) text += "2.5 " + shift + " 0 0 0 0 0 1\n";
    WriteFile(Path("a.tum"), text);
  }
  std::string Path(const std::string& name) const { return folder_ + name; }

  EvaluationInputs Inputs() const {
    EvaluationInputs inputs;
    inputs.trajectory = Path("a.tum");
    return inputs;
  }
  static Evaluation Measure(const EvaluationInputs& inputs) {
    Evaluation evaluation;
    const Status status = Evaluate(inputs, &evaluation);
    EXPECT_TRUE(status.ok()) << status.message();
    return evaluation;
  }
  static std::string ErrorOf(const EvaluationInputs& inputs) {
    Evaluation evaluation;
    return Evaluate(inputs, &evaluation).message();
  }

  const std::string folder_ = TempFolder();
};

TEST_F(EvaluateProgramTest, MeasuresOnlyWhatTheInputsGive) {
  WriteTrajectory("0.1");
  EvaluationInputs inputs = Inputs();
  inputs.relations = Path("a.relations");
  WriteFile(inputs.relations, "0.5 2.5 0.4 0.4 0 0 0 0\n1.5 99 0 0 0 0 0 0\n");
  const Evaluation evaluation = Measure(inputs);
  ASSERT_TRUE(evaluation.relations.has_value());
  EXPECT_FALSE(evaluation.trajectory || evaluation.raw_ranges || evaluation.points);
  EXPECT_NEAR(evaluation.relations->all.translation_m.mean, 0.5, 1e-12);  // (0.3, 0.4) m
  EXPECT_EQ(evaluation.relations->all.num_matched, 1u);
  EXPECT_EQ(evaluation.relations->all.num_unmatched, 1u);
}

TEST_F(EvaluateProgramTest, WritesTablesJsonAndCsv) {
  WriteTrajectory("0.1");
  EvaluationInputs inputs = Inputs();
  inputs.relations = Path("a.relations");
  WriteFile(inputs.relations, "0.5 2.5 0.1 0.25 0 0 0 0\n");
  inputs.truth = inputs.trajectory;
  const Evaluation evaluation = Measure(inputs);

  const std::string tables = EvaluationTables(evaluation);
  EXPECT_THAT(tables, AllOf(HasSubstr("relations, all            m         0.2500    0.0000"),
                            HasSubstr("relations, revisits       none"),
                            HasSubstr("absolute (ATE)            m         0.0000"),
                            Not(HasSubstr("nan")), Not(HasSubstr("map"))));

  ASSERT_TRUE(WriteEvaluationJson(Path("a.json"), evaluation).ok());
  const nlohmann::json json = nlohmann::json::parse(ReadFile(Path("a.json")));
  EXPECT_NEAR(json["relations"]["local"]["translation_m"]["mean"], 0.25, 1e-12);
  EXPECT_EQ(json["relations"]["revisits"]["matched"], 0);
  EXPECT_TRUE(json["relations"]["revisits"]["rotation_deg"]["max"].is_null());
  EXPECT_EQ(json["absolute"]["matched"], 3);
  EXPECT_EQ(json["relative"]["frames"]["matched"], 2);
  EXPECT_FALSE(json.contains("map_points"));

  ASSERT_TRUE(WriteEvaluationCsv(Path("a.csv"), evaluation).ok());
  EXPECT_THAT(ReadFile(Path("a.csv")), AllOf(StartsWith("figure,value\nrelations/all/matched,1\n"),
                                             HasSubstr("\nrelations/all/translation_m/mean,0.25\n"),
                                             HasSubstr("\nrelations/revisits/rotation_deg/max,\n"),
                                             HasSubstr("\nabsolute/rotation_deg/rmse,0.0\n")));
  EXPECT_EQ(WriteEvaluationCsv(Path("none/a.csv"), evaluation).code(), StatusCode::kUnavailable);
}

TEST_F(EvaluateProgramTest, AWrongPoseBlursTheMap) {
  WriteLog();
  EvaluationInputs inputs = Inputs();
  inputs.log = Path("a.clf");
  WriteTrajectory("0");
  const MapSharpness sharp = *Measure(inputs).raw_ranges;
  WriteTrajectory("0.05");
  const MapSharpness blurred = *Measure(inputs).raw_ranges;
  ASSERT_EQ(sharp.radii.size(), 3u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(sharp.radii[k].radius_m, blurred.radii[k].radius_m);
    EXPECT_GT(sharp.radii[k].quality.num_samples, 500u);
    // All that is left is the curvature of the wall: an arc's sagitta r^2 / (2 R).
    EXPECT_LT(sharp.radii[k].quality.wall_thickness_m,
              0.5 * sharp.radii[k].radius_m * sharp.radii[k].radius_m / 2.0);
    EXPECT_GT(blurred.radii[k].quality.wall_thickness_m, 0.01);
    EXPECT_GT(blurred.radii[k].quality.mean_map_entropy, sharp.radii[k].quality.mean_map_entropy);
  }
}

TEST_F(EvaluateProgramTest, ScansWithoutAPoseAreLeftOutAndCounted) {
  WriteLog();
  WriteTrajectory("");
  EvaluationInputs inputs = Inputs();
  inputs.log = Path("a.clf");
  const Evaluation evaluation = Measure(inputs);
  EXPECT_EQ(evaluation.num_scans_without_pose, 1u);
  EXPECT_EQ(evaluation.raw_ranges->num_points, 2u * 181u);
  EXPECT_THAT(EvaluationTables(evaluation), HasSubstr("1 scans have no pose"));
}

// Five scans on the way to a wall straight ahead, and their poses, all at one time.
class UselessClockTest : public EvaluateProgramTest {
 protected:
  UselessClockTest() {
    std::string log, poses;
    for (int scan = 0; scan < 5; ++scan) {
      log += "FLASER 181";
      for (int beam = 0; beam < 181; ++beam) {
        const double ahead = std::cos((beam - 90) * kPi / 180.0);
        log += ' ' + std::to_string(ahead > 0.2 ? (4.0 - 0.5 * scan) / ahead : 81.83);
      }
      log += " 0 0 0 0 0 0 0 host 0\n";
      poses += "0 " + std::to_string(0.5 * scan) + " 0 0 0 0 0 1\n";
    }
    WriteFile(Path("a.clf"), log);
    WriteFile(Path("a.tum"), poses);
    WriteFile(Path("short.tum"), poses.substr(0, poses.size() / 5 * 4));
  }
};

TEST_F(UselessClockTest, ScansAreAtPosesInTheirOrder) {
  EvaluationInputs inputs = Inputs();
  inputs.log = Path("a.clf");
  const Evaluation evaluation = Measure(inputs);
  EXPECT_TRUE(evaluation.log_by_order);
  EXPECT_LT(evaluation.raw_ranges->radii[0].quality.wall_thickness_m, 0.001);
  EXPECT_THAT(EvaluationTables(evaluation),
              HasSubstr("the clock is useless: scan i is put at pose i\n"));
  ASSERT_TRUE(WriteEvaluationJson(Path("a.json"), evaluation).ok());
  const nlohmann::json json = nlohmann::json::parse(ReadFile(Path("a.json")));
  EXPECT_EQ(json["map_raw_ranges"]["paired_by_order"], true);

  inputs.trajectory = Path("short.tum");
  EXPECT_THAT(ErrorOf(inputs),
              AllOf(StartsWith(Path("a.clf") + ": its clock is useless: 1 different time for 5 "),
                    HasSubstr(Path("short.tum") + " has not the same times")));
}

TEST_F(UselessClockTest, PosesAreComparedInTheirOrder) {
  EvaluationInputs inputs = Inputs();
  inputs.truth = Path("a.tum");
  const Evaluation evaluation = Measure(inputs);
  EXPECT_TRUE(evaluation.truth_by_order);
  EXPECT_NEAR(evaluation.trajectory->absolute.translation_m.max, 0.0, 1e-12);
  EXPECT_EQ(evaluation.trajectory->relative_frames.num_matched, 4u);
  EXPECT_THAT(EvaluationTables(evaluation),
              HasSubstr("the clock is useless: pose i is compared with true pose i\n"));
  ASSERT_TRUE(WriteEvaluationJson(Path("a.json"), evaluation).ok());
  const nlohmann::json json = nlohmann::json::parse(ReadFile(Path("a.json")));
  EXPECT_EQ(json["absolute"]["paired_by_order"], true);

  inputs.truth = Path("short.tum");
  EXPECT_THAT(ErrorOf(inputs), StartsWith(Path("short.tum") + ": its clock is useless"));
}

TEST_F(UselessClockTest, RelationsAreRefused) {
  EvaluationInputs inputs = Inputs();
  inputs.relations = Path("a.relations");
  WriteFile(inputs.relations, "0 1 0 0 0 0 0 0\n");
  EXPECT_EQ(ErrorOf(inputs), Path("a.tum") +
                                 ": its clock is useless: 1 different time for 5 entries: "
                                 "relations find their poses by time");
  WriteTrajectory("0");
  WriteFile(inputs.relations, "0.5 0.5 1 0 0 0 0 0\n1.5 1.5 1 0 0 0 0 0\n");
  EXPECT_EQ(ErrorOf(inputs),
            Path("a.relations") + ": its clock is useless: no relation has two different times");
}

TEST_F(EvaluateProgramTest, AGoodClockIsNotSpokenOf) {
  WriteLog();
  WriteTrajectory("0");
  EvaluationInputs inputs = Inputs();
  inputs.log = Path("a.clf");
  inputs.truth = Path("a.tum");
  const Evaluation evaluation = Measure(inputs);
  EXPECT_FALSE(evaluation.log_by_order || evaluation.truth_by_order);
  EXPECT_THAT(EvaluationTables(evaluation), Not(HasSubstr("useless")));
}

TEST_F(EvaluateProgramTest, PassesThatContradictEachOtherAreReported) {
  // A corridor along x with its wall 1.5 m to the left and to the right, driven to x = 10 m and,
  // with the laser looking back, home again. Beams every degree, straight ahead they meet nothing.
  std::string log, right, wrong;
  for (int scan = 0; scan <= 40; ++scan) {
    log += "FLASER 181";
    for (int beam = 0; beam < 181; ++beam) {
      const double lateral = std::abs(std::sin((beam - 90) * kPi / 180.0));
      log += ' ' + std::to_string(lateral > 0.2 ? 1.5 / lateral : 81.83);
    }
    const std::string time = std::to_string(scan) + ".5";
    log += " 0 0 0 0 0 0 " + time + " host 0\n";
    const bool outbound = scan <= 20;
    const std::string x = std::to_string(0.5 * (outbound ? scan : 40 - scan));
    const std::string heading = outbound ? " 0 0 0 0 1\n" : " 0 0 0 1 0\n";
    right += time + ' ' + x + " 0" + heading;
    wrong += time + ' ' + x + (outbound ? " 0" : " 1") + heading;
  }
  EvaluationInputs inputs = Inputs();
  inputs.log = Path("a.clf");
  WriteFile(inputs.log, log);
  WriteFile(inputs.trajectory, right);
  const Evaluation agreeing = Measure(inputs);
  EXPECT_GT(agreeing.consistency->between_passes.num_compared, 1000);
  EXPECT_EQ(agreeing.consistency->between_passes.num_conflicting, 0);
  EXPECT_THAT(EvaluationTables(agreeing),
              AllOf(Not(HasSubstr("contradicts")), Not(HasSubstr("nan"))));
  ASSERT_TRUE(WriteEvaluationCsv(Path("a.csv"), agreeing).ok());
  EXPECT_THAT(ReadFile(Path("a.csv")),
              AllOf(HasSubstr("\nmap_consistency/between_over_within,\n"),
                    HasSubstr("\nmap_consistency/between_passes/share,0.0\n")));

  WriteFile(inputs.trajectory, wrong);
  const Evaluation contradicting = Measure(inputs);
  EXPECT_GT(contradicting.consistency->between_passes.Share(), 0.99);
  EXPECT_THAT(EvaluationTables(contradicting), HasSubstr("the map contradicts itself."));
  ASSERT_TRUE(WriteEvaluationJson(Path("a.json"), contradicting).ok());
  const nlohmann::json json = nlohmann::json::parse(ReadFile(Path("a.json")))["map_consistency"];
  EXPECT_EQ(json["contradictory"], true);
  EXPECT_GT(json["worst_over_explicable"], 3.0);
  EXPECT_GT(json["between_over_within"], 3.0);
  ASSERT_TRUE(WriteEvaluationCsv(Path("a.csv"), contradicting).ok());
  EXPECT_THAT(ReadFile(Path("a.csv")), AllOf(HasSubstr("\nmap_consistency/between_passes/pairs,"),
                                             HasSubstr("\nmap_consistency/contradictory,true\n")));
}

TEST_F(EvaluateProgramTest, PointsNeedNoTrajectory) {
  WriteLog();
  WriteTrajectory("0");
  CarmenLog log;
  ASSERT_TRUE(ReadCarmenLog(Path("a.clf"), CarmenReadOptions(), &log).ok());
  SlamGraph graph;
  ASSERT_TRUE(BuildGraph(log, 0, &graph).ok());
  ASSERT_TRUE(WritePointsPly(Path("a.ply"), graph, graph.InitialState()).ok());
  EvaluationInputs of_points, of_log = Inputs();
  of_points.points = Path("a.ply");
  of_log.log = Path("a.clf");
  const MapSharpness points = *Measure(of_points).points;
  const MapSharpness raw_ranges = *Measure(of_log).raw_ranges;
  EXPECT_EQ(points.num_points, 3u * 181u);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(points.radii[k].quality.wall_thickness_m,
                raw_ranges.radii[k].quality.wall_thickness_m, 1e-9);
  }
}

TEST_F(EvaluateProgramTest, ErrorsNameFlagFileAndLine) {
  EXPECT_THAT(ErrorOf(EvaluationInputs()), HasSubstr("nothing to measure"));
  EvaluationInputs inputs;
  inputs.relations = Path("a.relations");
  EXPECT_THAT(ErrorOf(inputs), HasSubstr("--trajectory is missing"));
  inputs.trajectory = Path("a.tum");
  EXPECT_THAT(ErrorOf(inputs), HasSubstr("cannot open '" + Path("a.tum") + "'"));
  WriteTrajectory("far");
  EXPECT_EQ(ErrorOf(inputs), Path("a.tum") + ":3: field 'x': 'far' is not a number");
  WriteTrajectory("0");
  WriteFile(inputs.relations, "77 78 0 0 0 0 0 0\n");
  EXPECT_EQ(ErrorOf(inputs),
            Path("a.relations") + ": no relation's times are those of " + Path("a.tum"));
  inputs.relations_options.tolerance_s = -1.0;
  EXPECT_THAT(ErrorOf(inputs), HasSubstr("tolerance_s = -1"));

  inputs = Inputs();
  inputs.truth = Path("truth.tum");
  WriteFile(inputs.truth, "77 0 0 0 0 0 0 1\n");
  EXPECT_EQ(ErrorOf(inputs), Path("truth.tum") + ": no pose's time is one of " + Path("a.tum"));

  WriteLog();
  inputs = Inputs();
  inputs.log = Path("a.clf");
  WriteFile(inputs.trajectory, "77 0 0 0 0 0 0 1\n");
  EXPECT_THAT(ErrorOf(inputs), HasSubstr("a.clf: no scan with returns has a pose at its time"));
}

}  // namespace
}  // namespace plumbline
