// The programs from end to end, as a user runs them.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/apps/benchmark/log_variations.h"
#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/room_as_g2o.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;

using ProgramsTest = ProgramTest;

// A summary without what a run is told of threads and folders, and without what it measures of
// itself.
nlohmann::json WithoutTimes(const nlohmann::json& summary) {
  if (summary.is_array()) {
    nlohmann::json rest = nlohmann::json::array();
    for (const nlohmann::json& element : summary) rest.push_back(WithoutTimes(element));
    return rest;
  }
  if (!summary.is_object()) return summary;
  nlohmann::json rest = nlohmann::json::object();
  for (const auto& [key, value] : summary.items()) {
    const bool is_time = key.find("time_s") != std::string::npos;
    if (is_time || key == "peak_memory_bytes" || key == "threads" || key == "output_dir") continue;
    rest[key] = WithoutTimes(value);
  }
  return rest;
}

TEST_F(ProgramsTest, MapsTheSmallBuildingWithAnyNumberOfThreads) {
  SimulateLog(400);
  const std::string truth = "--truth=" + folder_ + "a.tum --hits=" + folder_ + "a.hits";
  const Outcome run = Slam("a.clf", truth + " --threads=1");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, AllOf(HasSubstr("400 scans"), HasSubstr("refined, optimised points")));
  EXPECT_EQ(FilesOf("out"), kResults);
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 400u);

  const nlohmann::json stages = Summary()["stages"];
  ASSERT_EQ(stages.size(), 4u);
  const auto& odometry = stages[0];
  const auto& seed = stages[1];
  const auto& refined = stages[3];
  EXPECT_LT(seed["mean_pose_error_m"], 0.2 * odometry["mean_pose_error_m"].get<double>());
  for (const char* error : {"mean_pose_error_m", "mean_pose_error_rad", "mean_point_error_m",
                            "wall_thickness_m", "mean_map_entropy"}) {
    EXPECT_LT(refined[error], seed[error]) << error;
  }
  EXPECT_LT(refined["mean_point_error_m"], 0.85 * seed["mean_point_error_m"].get<double>());

  const Outcome again = Slam("a.clf", truth + " --threads=3", "again");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  for (const std::string& name : kResults) {
    if (name == "summary.json" || name == "report.html") continue;  // they hold times
    EXPECT_TRUE(Result("out", name) == Result("again", name)) << name;
  }
  const nlohmann::json summary = nlohmann::json::parse(Result("again", "summary.json"));
  EXPECT_EQ(WithoutTimes(Summary()), WithoutTimes(summary));
  EXPECT_NE(Summary(), summary);  // so that it would notice
}

TEST_F(ProgramsTest, MapsWithCeres) {
  SimulateLog(20);
  const Outcome run = Slam("a.clf", "--solver=ceres --ceres=max_num_iterations=2");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(FilesOf("out"), kResults);
  EXPECT_EQ(Summary()["solver"]["solver"], "ceres");
  EXPECT_EQ(Summary()["flags"]["ceres"], "max_num_iterations=2");
}

TEST_F(ProgramsTest, PrintsNoLogLinesOfCeres) {
  SimulateLog(20);
  const Outcome run =
      Slam("a.clf",
           "--solver=ceres --ceres=minimizer_type=line_search,max_num_iterations=20,"
           "line_search_direction_type=nonlinear_conjugate_gradient,"
           "nonlinear_conjugate_gradient_type=polak_ribiere,"
           "line_search_type=armijo");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
}

TEST_F(ProgramsTest, MaxScansLimitsTheLog) {
  SimulateLog(5);
  const Outcome run = Slam("a.clf", "--max_scans=1");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 1u);
  EXPECT_EQ(Summary()["scans"], 1);
  EXPECT_EQ(Summary()["alarm"], false);
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, AllOf(HasSubstr("A single scan: there is nothing to match"),
                             Not(HasSubstr("nan")), Not(HasSubstr("inf "))));
}

TEST_F(ProgramsTest, ReplacesTheResultsOfAnEarlierRun) {
  SimulateLog(5);
  ASSERT_EQ(Slam("a.clf").exit_code, 0);
  ASSERT_EQ(Slam("a.clf", "--max_scans=2").exit_code, 0);
  EXPECT_EQ(FilesOf("out"), kResults);
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 2u);
}

TEST_F(ProgramsTest, ReadingsThatAreNoNumbersAreNoReturns) {
  SimulateLog(20);
  for (std::string& line : log_lines_) {
    if (line.compare(0, 11, "FLASER 360 ") == 0) line.replace(11, line.find(' ', 11) - 11, "nan");
  }
  WriteLog();
  const Outcome run = Slam("a.clf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(Result("out", "trajectory.tum"), Not(HasSubstr("nan")));
  EXPECT_THAT(Result("out", "points.ply"), Not(HasSubstr("nan")));
}

TEST_F(ProgramsTest, BadLinesAreNamedAndSkipped) {
  SimulateLog(20);
  log_lines_[5] = "FLASER 360 1.0 oops";
  log_lines_[8] += " more";
  WriteLog();
  const Outcome run = Slam("a.clf");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(Lines(run.err).size(), 3u) << run.err;
  EXPECT_THAT(run.err, HasSubstr(folder_ + "a.clf:6: FLASER field 'range"));
  EXPECT_THAT(run.err, HasSubstr(folder_ + "a.clf:9: ODOM "));
  EXPECT_THAT(run.err, HasSubstr("a.clf: 2 of 42 records are skipped; the first one: "));
  EXPECT_EQ(Summary()["warnings"][0]["id"], "skipped_records");
  EXPECT_EQ(Lines(Result("out", "trajectory.tum")).size(), 19u);
  EXPECT_EQ(Summary()["skipped_records"], 2);
}

TEST_F(ProgramsTest, TooManyBadLinesAreAnError) {
  SimulateLog(20);
  for (int i = 0; i < 12; ++i) log_lines_[3 + 2 * i] = "FLASER 360 oops";
  WriteLog();
  ExpectError(Slam("a.clf"), "12 of 42 records are unreadable");
  EXPECT_THAT(Slam("a.clf").err, HasSubstr(folder_ + "a.clf:4: "));
}

TEST_F(ProgramsTest, LogsThatCannotBeMapped) {
  ExpectError(Slam("none.clf"), "cannot open '" + folder_ + "none.clf'");
  ExpectError(Slam(""), folder_ + ": a folder, but no bag of ROS 2");
  WriteFile(folder_ + "a.clf", "# a log\nODOM 0 0 0 0 0 0 0 host 0\n");
  ExpectError(Slam("a.clf"), folder_ + "a.clf: no FLASER");
  WriteFile(folder_ + "a.clf", "");
  ExpectError(Slam("a.clf"), folder_ + "a.clf: no FLASER");
  WriteFile(folder_ + "a.g2o", "");
  ExpectError(Slam("a.g2o"), folder_ + "a.g2o: the file holds no vertices");
}

TEST_F(ProgramsTest, WarnsOfASecondLaser) {
  SimulateLog(10);
  std::string& scan = log_lines_[5];
  std::vector<std::string> fields;
  std::istringstream stream(scan);
  for (std::string field; stream >> field;) fields.push_back(field);
  fields[362] = std::to_string(std::stod(fields[362]) + 0.5);  // laser_x
  scan.clear();
  for (const std::string& field : fields) scan += (scan.empty() ? "" : " ") + field;
  WriteLog();
  const Outcome run = Slam("a.clf");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(Lines(run.err).size(), 1u) << run.err;
  EXPECT_THAT(run.err, HasSubstr("differs by up to 0.5 m and 0 deg between scans"));
}

TEST_F(ProgramsTest, ALogWithoutAnyReturnIsAnError) {
  WriteStandingLog(10, "3 81.91 81.91 nan");
  ExpectError(Slam("a.clf"), folder_ + "a.clf: no scan has a return");
}

TEST_F(ProgramsTest, AFolderThatCannotBeMadeIsAnError) {
  SimulateLog(2);
  WriteFile(folder_ + "file", "in the way");
  ExpectError(Slam("a.clf", "", "file"), "cannot make the folder '" + folder_ + "file'",
              kExitCannotWrite);
  ExpectError(Slam("a.clf", "", "file/deeper"), "cannot make the folder", kExitCannotWrite);
  EXPECT_EQ(ReadFile(folder_ + "file"), "in the way");
}

TEST_F(ProgramsTest, BadFlagsAreNamed) {
  ExpectUsageError(Run("slam", ""), "--log is missing");
  ExpectUsageError(Run("slam", "--log=a.clf"), "--output_dir is missing");
  ExpectUsageError(Slam("a.clf", "--threads=0"), "num_threads = 0");
  ExpectUsageError(Slam("a.clf", "--threads=many"), "'many' specified for int32 flag 'threads'");
  ExpectUsageError(Slam("a.clf", "--solver=magic"), "--solver=magic");
  ExpectUsageError(Slam("a.clf", "--cg_max_sweeps=5"),
                   "--cg_max_sweeps is ignored by --solver=reduced");
  ExpectUsageError(Run("benchmark", "--experiment=adversarial --coarse_rounds=2"),
                   "--coarse_rounds is ignored by --solver=reduced");
  for (const char* ignored :
       {"seeding_study --shape", "scaling --solver=sgd", "sensors --shape",
        "solver_comparison --solver=ceres", "replay --start=icp", "log --solvers=reduced",
        "scaling,sensors --repeats=1", "profile --time_limit_s=5"}) {
    const std::string text = ignored, flag = text.substr(text.find("--"));
    ExpectUsageError(Run("benchmark", "--output_dir=out --log=a.clf --experiment=" + text),
                     flag.substr(0, flag.find('=')) +
                         " is ignored by --experiment=" + text.substr(0, text.find(' ')));
  }
  const std::string comparison = "--experiment=solver_comparison --output_dir=out ";
  ExpectUsageError(Run("benchmark", comparison + "--solvers=reduced,ceres:newton"),
                   "--solvers: entry 'ceres:newton': ceres has no word 'newton'");
  for (const char* ignored :
       {"ceres=minimizer_type=line_search", "cg_max_sweeps=5 --solvers=ceres,sgd",
        "coarse_rounds=1 --solvers=reduced,published", "reduced --solvers=reduced",
        "reduced_tolerance=1 --solvers=ceres:points", "keyframe_distance_m=5 --start=icp"}) {
    const std::string text = ignored, flag = text.substr(0, text.find(' '));
    ExpectUsageError(
        Run("benchmark", comparison + "--" + text),
        "--" + flag.substr(0, flag.rfind('=')) + " is ignored by every entry of --solvers");
  }
  ExpectUsageError(Slam("a.clf", "--max_scans=-1"), "--max_scans");
  ExpectUsageError(Slam("a.clf", "--hits=a.hits"), "--hits needs --truth");
  ExpectUsageError(Slam("a.clf", "--no_such_flag=1"), "no_such_flag");
  ExpectUsageError(Slam("a.clf", "stray"), "unexpected argument 'stray'");
  ExpectUsageError(Run("simulate", ""), "--world is missing");
  ExpectUsageError(Run("simulate", "--world=a --building=random"), "exclude each other");
  ExpectUsageError(Run("simulate", "--building=castle --log=a.clf"), "--building=castle");
  ExpectUsageError(Run("simulate", "--no_such_flag=1"), "no_such_flag");
}

TEST_F(ProgramsTest, SimulatesTheSameBuildingFromTheSameSeed) {
  for (const char* name : {"a.clf", "b.clf"}) {
    const Outcome run =
        Run("simulate", "--building=repetitive --seed=3 --num_beams=9 --log=" + folder_ + name +
                            " --carry_at_path_m=30 " + "--carry_distance_m=2");
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  EXPECT_TRUE(ReadFile(folder_ + "a.clf") == ReadFile(folder_ + "b.clf"));
}

TEST_F(ProgramsTest, SimulatesFaultsAndRefusesBadOnesByTheirFlag) {
  const std::string drive = "--building=random --seed=3 --num_beams=9 --log=" + folder_ + "a.clf ";
  const Outcome frozen = Run("simulate", drive + "--fault=frozen --fault_time_s=6");
  ASSERT_EQ(frozen.exit_code, 0) << frozen.err;
  EXPECT_THAT(frozen.out, HasSubstr("\nfault frozen from scan "));
  ASSERT_EQ(Run("simulate", drive + "--fault=two_buildings").exit_code, 0);
  const std::vector<std::vector<std::string>> refused = {
      {"--fault=broken", "--fault=broken"},
      {"--fault=injected", "--fault=injected"},
      {"--fault_at_share=0.5", "--fault_at_share does not belong to --fault=none"},
      {"--fault=frozen --fault_distance_m=2", "--fault_distance_m does not belong"},
      {"--fault=frozen --fault_at_share=1.5", "--fault_at_share: the fault's at_share = 1.5"},
      {"--fault=mounting --fault_angle_deg=nan", "--fault_angle_deg"},
      {"--fault=carried --carry_distance_m=1", "--fault and --carry_distance_m"},
      {"--fault=slip --odom_leap_distance_m=1", "--fault and --odom_leap_distance_m"}};
  for (const auto& pair : refused) ExpectUsageError(Run("simulate", drive + pair[0]), pair[1]);
  ExpectUsageError(Run("simulate", "--world=a --log=a.clf --fault=two_buildings"),
                   "--fault=two_buildings needs --building");
}

TEST_F(ProgramsTest, ReplaysADriveWithABrokenStep) {
  const std::string log = folder_ + "carried.clf";
  ASSERT_EQ(Run("simulate",
                "--building=repetitive --seed=95004 --fault=carried_in_gap "
                "--fault_distance_m=1.09 --fault_at_share=0.6 --scan_period_s=0.45 "
                "--num_beams=181 --bearing_step_deg=1 --max_range_m=8 --log=" +
                    log)
                .exit_code,
            0);
  const Outcome run = Run("benchmark", "--experiment=replay --batch_scans=100 --log=" + log +
                                           " --output_dir=" + folder_ + "out");
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST_F(ProgramsTest, StudiesTheSeeding) {
  const Outcome run =
      Run("benchmark", "--experiment=seeding_study --buildings=4 --study_first_seed=3 --csv=" +
                           folder_ + "study.csv");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, AllOf(HasSubstr("wrong, SILENT"), HasSubstr("\n4 runs in ")));
  EXPECT_EQ(Lines(ReadFile(folder_ + "study.csv")).size(), 5u);
  ExpectUsageError(Run("benchmark", "--experiment=magic"), "--experiment='magic'");
  ExpectUsageError(Run("benchmark", "--experiment=seeding_study --study_scanner=long"),
                   "--study_scanner=long");
  ExpectUsageError(Run("benchmark", "--experiment=log --output_dir=" + folder_ + "out"), "--log");
}

TEST_F(ProgramsTest, MapsVariationsOfLogs) {
  SimulateLog(20);
  const std::string study =
      "--experiment=variations --variations=mirror --log=" + folder_ + "a.clf ";
  EXPECT_THAT(Run("benchmark", study).err, HasSubstr("want '" + folder_ + "a.relations'"));
  WriteFile(folder_ + "a.relations", "0 3 0.5 0 0 0 0 0\n");
  const Outcome run = Run("benchmark", study + "--csv=" + folder_ + "variations.csv");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, AllOf(HasSubstr("\na                mirror "), HasSubstr("wrong, SILENT")));
  EXPECT_EQ(Lines(ReadFile(folder_ + "variations.csv")).size(), 3u);
  ExpectUsageError(Run("benchmark", study + "--csv=" + folder_ + "a.relations"), "--csv");
  ExpectUsageError(Run("benchmark", study + "--variations=sideways"),
                   "--variations: there is no variation 'sideways'; want some of all, same, late");
  ExpectUsageError(Run("benchmark", study + "--relations=" + folder_ + "a.relations"),
                   "--relations is ignored by --experiment=variations");
  ExpectUsageError(Run("benchmark", "--experiment=variations"), "--log is missing");
  std::string names;
  for (const LogVariation& variation : LogVariations()) names += variation.name + std::string(", ");
  EXPECT_NE(Run("benchmark", "--help").out.find(names + "or all"), std::string::npos) << names;
}

TEST_F(ProgramsTest, ReplaysAMapper) {
  WriteFile(folder_ + "room.g2o", AsG2o(MakeNoisyRoom()));
  const std::string replay = "--experiment=scan_solver --graph=" + folder_ + "room.g2o ";
  const Outcome run = Run("benchmark", replay + "--csv=" + folder_ + "calls.csv");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("\n1 computations, the last with 12 nodes and 12 edges\n"),
                             HasSubstr("wall time: mean "), HasSubstr("CPU time:  mean ")));
  EXPECT_EQ(Lines(ReadFile(folder_ + "calls.csv")).size(), 2u);
  ExpectUsageError(Run("benchmark", replay + "--relations=a.relations"), "need --log");
}

TEST_F(ProgramsTest, MapsALogOnline) {
  SimulateLog(50);
  const std::string online =
      "--experiment=online --log=" + folder_ + "a.clf --output_dir=" + folder_ + "out ";
  ExpectUsageError(Run("benchmark", online + "--online_speed=-1"), "--online_speed");
  ExpectUsageError(Run("benchmark", online + "--online_hours=25"), "--online_hours");
  EXPECT_THAT(Run("benchmark", online + "--relations=" + folder_ + "none").err, HasSubstr("none"));
  const Outcome run = Run("benchmark", online + "--online_speed=0");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("50 scans of "));
  EXPECT_THAT(run.out, HasSubstr("live, each when it was given"));
  EXPECT_THAT(FilesOf("out"), ElementsAre("online.csv", "report.html"));
  EXPECT_EQ(Lines(Result("out", "online.csv")).size(), 1u + 50u);
}

TEST_F(ProgramsTest, ReplaysALog) {
  SimulateLog(50);
  const std::string replay = "--experiment=replay --log=" + folder_ + "a.clf ";
  ExpectUsageError(Run("benchmark", replay), "--output_dir");
  ExpectUsageError(Run("benchmark", replay + "--output_dir=" + folder_ + "out --batch_scans=0"),
                   "--batch_scans");
  ExpectUsageError(
      Run("benchmark", replay + "--output_dir=" + folder_ + "out --solver=alternating_cg"),
      "--solver=alternating_cg does not go with --experiment=replay");
  const Outcome run = Run("benchmark", replay + "--output_dir=" + folder_ + "out --batch_scans=20");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("poses       online: "));
  EXPECT_THAT(FilesOf("out"),
              ElementsAre("replay.csv", "replay.png", "report.html", "trajectory.tum"));
  EXPECT_EQ(Lines(Result("out", "replay.csv")).size(), 1u + 3u + 1u);
}

TEST_F(ProgramsTest, ComparesTheSolversThatAreNamed) {
  SimulateLog(50);
  const std::string files = "--log=" + folder_ + "a.clf --output_dir=" + folder_ + "out ";
  const std::string comparison = "--experiment=solver_comparison --repeats=1 " + files;
  const Outcome run = Run(
      "benchmark", comparison +
                       "--solvers=ceres:lbfgs:reduced,reduced,pose_graph,ceres --start=odometry "
                       "--ceres=minimizer_type=line_search,max_num_iterations=2");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(FilesOf("out"), ElementsAre("report.html", "solver_comparison.csv",
                                          "solver_comparison.json", "solver_comparison.png"));
  const auto json = nlohmann::json::parse(Result("out", "solver_comparison.json"));
  EXPECT_EQ(json["start"], "odometry");
  // "solver",repeat,iteration,time_s,cpu_time_s,marginal_energy,gap
  std::istringstream first_state(Lines(Result("out", "solver_comparison.csv"))[1]);
  std::string field;
  for (int i = 0; i < 6; ++i) std::getline(first_state, field, ',');
  const double start_energy = std::stod(field);
  std::vector<std::string> names;
  for (const auto& solver : json["solvers"]) {
    names.push_back(solver["solver"]);
    EXPECT_THAT(solver["failures"], IsEmpty());
    EXPECT_THAT(run.out, HasSubstr("\n" + names.back() + " "));
    EXPECT_LT(solver["final_marginal_energy"], start_energy) << names.back();
  }
  EXPECT_THAT(names, ElementsAre("ceres reduced line_search lbfgs wolfe", "reduced", "pose_graph",
                                 "ceres line_search lbfgs wolfe"));
}

TEST_F(ProgramsTest, ProfilesTheStagesOfALog) {
  SimulateLog(50);
  const std::string profile = "--experiment=profile --log=" + folder_ + "a.clf ";
  ExpectUsageError(Run("benchmark", profile), "--output_dir");
  const Outcome run = Run("benchmark", profile + "--output_dir=" + folder_ + "out");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(FilesOf("out"), ElementsAre("before_after.png", "conflicts.png", "map.pgm",
                                          "map.yaml", "map_refined.png", "points.pcd", "points.ply",
                                          "profile.csv", "report.html"));
  std::vector<std::string> stages;
  for (const std::string& line : Lines(Result("out", "profile.csv"))) {
    stages.push_back(line.substr(0, line.find(',')));
    EXPECT_THAT(run.out, HasSubstr(stages.back().substr(1, stages.back().size() - 2)));
  }
  EXPECT_THAT(stages, ElementsAre("stage", "\"reading\"", "\"surfaces\"", "\"matching scans\"",
                                  "\"closing loops\"", "\"joint estimation\"",
                                  "\"sharpness of a map\"", "\"pictures and points\""));
}

TEST_F(ProgramsTest, TruthOfAnotherLogIsAnError) {
  SimulateLog(2);
  WriteFile(folder_ + "a.tum", "77 0 0 0 0 0 0 1\n");
  ExpectError(Slam("a.clf", "--truth=" + folder_ + "a.tum"), folder_ + "a.tum: no pose");
}

TEST_F(ProgramsTest, EvaluatesScansOfAUselessClockInTheirOrder) {
  std::string log, poses;
  for (int scan = 0; scan < 3; ++scan) {
    log += "FLASER 5 2 2 2 2 2 0 0 0 0 0 0 0 host 0\n";
    poses += "0 0 0 0 0 0 0 1\n";
  }
  WriteFile(folder_ + "a.clf", log);
  WriteFile(folder_ + "a.tum", poses);
  const std::string flags = "--log=" + folder_ + "a.clf --trajectory=" + folder_ + "a.tum";
  const Outcome run = Run("evaluate", flags);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("the clock is useless: scan i is put at pose i"));
  WriteFile(folder_ + "a.tum", poses + poses);
  ExpectError(Run("evaluate", flags), folder_ + "a.clf: its clock is useless");
}

TEST_F(ProgramsTest, AClockThatStandsStillIsNoted) {
  SimulateLog(20);
  for (std::string& line : log_lines_) {
    const std::size_t host = line.find(" simulator ");
    if (host == line.npos) continue;  // a parameter
    line = line.substr(0, line.rfind(' ', host - 1)) + " 7 host 7";
  }
  WriteLog();
  const Outcome run = Slam("a.clf", "--picture_side_px=200");
  ASSERT_EQ(run.exit_code, 0);
  const std::string message =
      folder_ +
      "a.clf: its clock is useless: 1 different time for 20 entries; the scans "
      "are taken in the order of the file";
  EXPECT_EQ(run.err, "warning: " + message + " [useless_clock]\n");
  EXPECT_EQ(Summary()["warnings"],
            nlohmann::json::array({{{"id", "useless_clock"}, {"message", message}}}));
  EXPECT_THAT(Result("out", "report.html"), HasSubstr(message + " [useless_clock]"));
  EXPECT_EQ(Summary()["alarm"], false);
}

TEST_F(ProgramsTest, HelpShowsTheFlagsOfTheProgram) {
  const Outcome slam = Run("slam", "--help");
  EXPECT_EQ(slam.exit_code, 0);
  EXPECT_THAT(slam.out, AllOf(HasSubstr("  --output_dir="), HasSubstr("  --threads=2"),
                              Not(HasSubstr("logtostderr")), Not(HasSubstr("speed_m_s"))));
  const Outcome simulate = Run("simulate", "--help");
  EXPECT_EQ(simulate.exit_code, 0);
  EXPECT_THAT(simulate.out, AllOf(HasSubstr("  --speed_m_s="), Not(HasSubstr("--threads"))));
}

TEST_F(ProgramsTest, VersionIsThatOfTheProject) {
  const Outcome run = Run("slam", "--version");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, MatchesRegex("plumbline_slam [0-9]+[.][0-9]+[.][0-9]+\n"));
  EXPECT_EQ(Run("slam", "--helpshort").exit_code, 0);
  EXPECT_EQ(Run("slam", "--helpfull").exit_code, 0);
}

}  // namespace
}  // namespace plumbline
