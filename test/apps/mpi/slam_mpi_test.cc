// plumbline_slam_mpi as a user runs it, next to plumbline_slam.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "plumbline/test/apps/program_testing.h"
#include "plumbline/test/apps/running_program.h"

namespace plumbline {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

#ifdef PLUMBLINE_MPIRUN

const std::string kName = "plumbline_slam_mpi";

// Made-up buildings with short drives.
constexpr int kHome = 43, kElsewhere = 34;

std::vector<double> NumbersIn(const std::string& text) {
  std::istringstream stream(text);
  std::vector<double> numbers;
  for (double number = 0.0; stream >> number;) numbers.push_back(number);
  return numbers;
}

std::set<std::string> KeysOf(const nlohmann::json& json) {
  std::set<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.insert(key);
  return keys;
}

class SlamMpiTest : public ProgramTest {
 protected:
  // As root and on any number of processors, where mpirun would rather not, and without a rest of
  // two seconds after a failure.
  static std::string Mpirun(int num_processes) {
    return "env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
           "OMPI_MCA_rmaps_base_oversubscribe=1 "
           "OMPI_MCA_odls_base_sigkill_timeout=0 " PLUMBLINE_MPIRUN " -n " +
           std::to_string(num_processes) + " ";
  }

  Outcome SlamMpi(int num_processes, const std::string& log, const std::string& flags = "",
                  const std::string& output_dir = "out") {
    limits_ = Mpirun(num_processes);
    const Outcome run = Run("slam_mpi", "--log=" + folder_ + log + " --output_dir=" + folder_ +
                                            output_dir + " --threads=1 " + flags);
    limits_.clear();
    return run;
  }

  nlohmann::json SummaryIn(const std::string& output_dir) const {
    return nlohmann::json::parse(Result(output_dir, "summary.json"));
  }

  // mpirun adds lines of its own.
  static std::vector<std::string> OwnLines(const Outcome& run) {
    std::vector<std::string> own;
    for (const std::string& line : Lines(run.err)) {
      if (line.rfind(kName + ": ", 0) == 0) own.push_back(line);
    }
    return own;
  }

  void ExpectOneError(const Outcome& run, int exit_code, const std::string& message) const {
    EXPECT_EQ(run.exit_code, exit_code) << run.err;
    const std::vector<std::string> lines = OwnLines(run);
    ASSERT_EQ(lines.size(), 1u) << run.err;
    EXPECT_THAT(lines.front(), HasSubstr(message));
  }

  void ExpectSamePoses(const std::string& output_dir, const std::string& expected_dir) const {
    const std::vector<double> poses = NumbersIn(Result(output_dir, "trajectory.tum"));
    const std::vector<double> expected = NumbersIn(Result(expected_dir, "trajectory.tum"));
    ASSERT_EQ(poses.size(), expected.size());
    for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_NEAR(poses[i], expected[i], 1e-4);
  }

  // A drive through a made-up building, on some day.
  void SimulateVisit(const std::string& name, int seed, int visit,
                     const std::string& flags = "") const {
    const Outcome run =
        Run("simulate",
            "--building=random --scan_period_s=1 --num_beams=90 --bearing_step_deg=4 --seed=" +
                std::to_string(seed) + " --visit=" + std::to_string(visit) + " --log=" + folder_ +
                name + ".clf " + flags);
    ASSERT_EQ(run.exit_code, kExitDone) << run.err;
  }

  // Line by line, in saved maps.
  void ExpectSameScans(const std::string& output_dir, const std::string& expected_dir) const {
    const std::vector<std::string> lines = Lines(Result(output_dir, "map.g2o")),
                                   expected = Lines(Result(expected_dir, "map.g2o"));
    ASSERT_EQ(lines.size(), expected.size());
    EXPECT_THAT(lines, testing::Contains(testing::StartsWith("ROBOTLASER1")));
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string keyword = expected[i].substr(0, expected[i].find(' '));
      EXPECT_EQ(lines[i].substr(0, lines[i].find(' ')), keyword);
      if (keyword == "ROBOTLASER1") {
        EXPECT_EQ(lines[i], expected[i]);
      }
    }
  }

  // Of files that no clock and no memory gets into.
  void ExpectSameBytes(const std::string& output_dir, const std::string& expected_dir) const {
    for (const char* name : {"points.ply", "points.pcd", "trajectory.tum", "graph.g2o", "map.pgm",
                             "map_refined.png", "conflicts.png", "before_after.png"}) {
      EXPECT_TRUE(Result(output_dir, name) == Result(expected_dir, name)) << name;
    }
  }
};

TEST_F(SlamMpiTest, WritesWhatOneProcessWritesWithAnyNumberOfProcesses) {
  SimulateLog(200);
  const std::string truth = "--truth=" + folder_ + "a.tum --hits=" + folder_ + "a.hits";
  ASSERT_EQ(Slam("a.clf", truth, "one").exit_code, 0);
  const nlohmann::json expected = SummaryIn("one");
  for (const int num_processes : {1, 4}) {
    SCOPED_TRACE(num_processes);
    const std::string folder = "of_" + std::to_string(num_processes);
    const Outcome run = SlamMpi(num_processes, "a.clf", truth, folder);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(OwnLines(run), IsEmpty());
    EXPECT_EQ(FilesOf(folder), FilesOf("one"));
    const nlohmann::json summary = SummaryIn(folder);
    EXPECT_EQ(KeysOf(summary), KeysOf(expected));
    EXPECT_EQ(summary["processes"].size(), num_processes > 1 ? num_processes : 0u);
    EXPECT_EQ(summary["returns"], expected["returns"]);
    const double energy = expected["solver"]["marginal_energy_final"];
    EXPECT_NEAR(summary["solver"]["marginal_energy_final"], energy, 1e-6 * energy);
    const double thickness_m = expected["stages"].back()["wall_thickness_m"];
    EXPECT_NEAR(summary["stages"].back()["wall_thickness_m"], thickness_m, 1e-5);
    ASSERT_EQ(summary["stages"].size(), expected["stages"].size());
    for (std::size_t i = 0; i < expected["stages"].size(); ++i) {
      for (const char* error : {"mean_pose_error_m", "mean_point_error_m"}) {
        const double error_m = expected["stages"][i][error];
        EXPECT_NEAR(summary["stages"][i][error], error_m, 1e-6) << expected["stages"][i]["name"];
      }
    }
    // Nothing of this was solved.
    EXPECT_EQ(summary["seeding"]["loop_closures"], expected["seeding"]["loop_closures"]);
    EXPECT_TRUE(Result(folder, "map_seed.png") == Result("one", "map_seed.png"));
    EXPECT_TRUE(Result(folder, "map_odometry.png") == Result("one", "map_odometry.png"));
    EXPECT_EQ(Result(folder, "points.ply").size(), Result("one", "points.ply").size());
    EXPECT_EQ(Result(folder, "points.pcd").size(), Result("one", "points.pcd").size());
    ExpectSamePoses(folder, "one");
  }
}

TEST_F(SlamMpiTest, TheSameNumberOfProcessesWritesTheSameBytes) {
  SimulateLog(120);
  for (const char* folder : {"first", "second"}) {
    ASSERT_EQ(SlamMpi(3, "a.clf", "", folder).exit_code, 0);
  }
  ExpectSameBytes("second", "first");
}

// Scans that were frozen are left out before the log is shared; without odometry, and where lasers
// sweep, one process seeds for all.
TEST_F(SlamMpiTest, MapsLogsOfAllKinds) {
  const struct {
    const char *name, *simulated, *flags;
  } kinds[] = {{"frozen", "--fault=frozen --fault_time_s=2 --fault_at_share=0.05", ""},
               {"sweeps", "--sweep_time_s=0.02", ""},
               {"matched", "", "--start=icp_point_to_line"}};
  for (const auto& [name, simulated, flags] : kinds) {
    SCOPED_TRACE(name);
    SimulateLog(90, simulated);
    ASSERT_EQ(Slam("a.clf", flags, "one").exit_code, 0);
    const Outcome run = SlamMpi(2, "a.clf", flags, "two");
    ASSERT_EQ(run.exit_code, 0) << run.err;
    ExpectSamePoses("two", "one");
    for (const char* folder : {"one", "two"}) {
      EXPECT_EQ(SummaryIn(folder).at("seeding").at("frozen_laser").size(),
                name == std::string("frozen") ? 1u : 0u);
    }
  }
}

TEST_F(SlamMpiTest, SharesASavedMap) {
  SimulateLog(80);
  ASSERT_EQ(Slam("a.clf", "--save_map", "map").exit_code, 0);
  std::ofstream(folder_ + "map/map.g2o", std::ios::app)  // a false closure
      << "EDGE_SE2 0 40 0.3 0.2 1 400 0 0 400 0 400\n";
  ASSERT_EQ(Slam("map/map.g2o", "", "one").exit_code, 0);
  const Outcome run = SlamMpi(2, "map/map.g2o", "", "two");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(FilesOf("two"), FilesOf("one"));
  EXPECT_EQ(KeysOf(SummaryIn("two")), KeysOf(SummaryIn("one")));
  const auto ignored_edge_in = [this](const std::string& folder) {
    const nlohmann::json edges = SummaryIn(folder).at("joint").at("local").at("ignored_edges");
    EXPECT_EQ(edges.size(), 1u);
    return edges.at(0);
  };
  EXPECT_EQ(ignored_edge_in("one").at("to"), 40);
  EXPECT_EQ(ignored_edge_in("two").at("from"), ignored_edge_in("one").at("from"));
  EXPECT_EQ(ignored_edge_in("two").at("to"), ignored_edge_in("one").at("to"));
  ExpectSamePoses("two", "one");
}

// Two drives through one building and one through another, which sweeping lasers let one process
// seed for all.
TEST_F(SlamMpiTest, MapsSeveralLogsAsOneProcessDoes) {
  const std::string logs = "a.clf," + folder_ + "b.clf," + folder_ + "c.clf";
  for (const char* simulated : {"", "--sweep_time_s=0.02"}) {
    SCOPED_TRACE(simulated);
    SimulateVisit("a", kHome, 1, simulated);
    SimulateVisit("b", kHome, 2, simulated);
    SimulateVisit("c", kElsewhere, 0, simulated);
    // What was moved within a sweep has no place in a saved map.
    const bool is_swept = simulated[0] != '\0';
    const std::string flags =
        std::string("--picture_side_px=400 ") + (is_swept ? simulated : "--save_map");
    ASSERT_EQ(Slam(logs, flags, "one").exit_code, 0);
    // Two processes where one seeds for all: a waiting process takes a processor.
    const Outcome run = SlamMpi(is_swept ? 2 : 3, logs, flags, "several");
    ASSERT_EQ(run.exit_code, 0) << run.err;
    EXPECT_EQ(FilesOf("several"), FilesOf("one"));
    const nlohmann::json summary = SummaryIn("several"), expected = SummaryIn("one");
    EXPECT_EQ(KeysOf(summary), KeysOf(expected));
    EXPECT_EQ(summary["maps"], expected["maps"]);
    EXPECT_EQ(summary["ties"], expected["ties"]);
    ASSERT_EQ(expected["maps"].size(), 2u);
    for (const char* map : {"/map_1", "/map_2"}) {
      SCOPED_TRACE(map);
      const std::string own = std::string("several") + map, of_one = std::string("one") + map;
      EXPECT_EQ(FilesOf(own), FilesOf(of_one));
      EXPECT_EQ(KeysOf(SummaryIn(own)), KeysOf(SummaryIn(of_one)));
      EXPECT_TRUE(Result(own, "map_seed.png") == Result(of_one, "map_seed.png"));
      EXPECT_EQ(Result(own, "points.ply").size(), Result(of_one, "points.ply").size());
      ExpectSamePoses(own, of_one);
      if (!is_swept) ExpectSameScans(own, of_one);
    }
    EXPECT_EQ(SummaryIn("several/map_1")["sessions"], SummaryIn("one/map_1")["sessions"]);
    EXPECT_GT(SummaryIn("one/map_1")["changes"].size(), 0u);
    EXPECT_EQ(SummaryIn("several/map_1")["changes"].size(),
              SummaryIn("one/map_1")["changes"].size());
  }
}

TEST_F(SlamMpiTest, LocalisesInAMapThatStaysAsItIs) {
  SimulateVisit("a", kHome, 1);
  SimulateVisit("b", kHome, 2);
  ASSERT_EQ(SlamMpi(2, "a.clf", "--save_map", "map").exit_code, 0);
  const std::string fixed = "--fixed_map=" + folder_ + "map/map.g2o";
  ASSERT_EQ(Slam("b.clf", fixed, "one").exit_code, 0);
  EXPECT_EQ(SummaryIn("one")["ties"][0]["outcome"], "tied");
  const Outcome run = SlamMpi(2, "b.clf", fixed, "two");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(FilesOf("two"), FilesOf("one"));
  EXPECT_TRUE(Result("two", "trajectory_2.tum") == Result("map", "trajectory.tum"));
  ExpectSamePoses("two", "one");
}

TEST_F(SlamMpiTest, SaysOnceWhatIsWrong) {
  ExpectOneError(SlamMpi(2, "nothing.clf"), kExitBadInput, "nothing.clf");
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out"));
  const Outcome run = SlamMpi(2, "a.clf", "--no_such_flag");
  EXPECT_EQ(run.exit_code, kExitWrongUsage);
  const std::size_t first = run.err.find("no_such_flag");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(run.err.find("no_such_flag", first + 1), std::string::npos);
}

TEST_F(SlamMpiTest, CalibratesAndTakesShapeAsOneProcessDoes) {
  SimulateLog(100);
  const std::string flags = "--shape --calibrate=mounting,range_bias";
  ASSERT_EQ(Slam("a.clf", flags, "one").exit_code, 0);
  const Outcome run = SlamMpi(2, "a.clf", flags, "two");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ExpectSamePoses("two", "one");
  const nlohmann::json expected = SummaryIn("one").at("calibration").at("parameters"),
                       parameters = SummaryIn("two").at("calibration").at("parameters");
  ASSERT_EQ(expected.size(), 4u);
  for (const auto& [name, parameter] : expected.items()) {
    EXPECT_NEAR(parameters.at(name).at("value"), parameter.at("value"), 1e-6) << name;
  }
  const auto num_shapes_in = [this](const std::string& folder) {
    const nlohmann::json terms = SummaryIn(folder).at("solver").at("terms");
    for (const nlohmann::json& term : terms) {
      if (term.at("term") == "shape") return term.at("count").get<int>();
    }
    return -1;
  };
  EXPECT_GT(num_shapes_in("one"), 0);
  EXPECT_EQ(num_shapes_in("two"), num_shapes_in("one"));
}

TEST_F(SlamMpiTest, RefusesByNameWhatProcessesCannotShare) {
  for (const char* given : {"--solver=ceres", "--solver=published"}) {
    const std::string flag = given;
    const Outcome run = SlamMpi(1, "a.clf", flag);
    ExpectOneError(run, kExitWrongUsage, flag.substr(0, flag.find('=')));
  }
}

TEST_F(SlamMpiTest, LeavesNoHalfWrittenFile) {
  SimulateLog(60);
  std::filesystem::create_directories(folder_ + "out/points.ply/taken");
  ExpectOneError(SlamMpi(2, "a.clf"), kExitCannotWrite, "points.ply");
  for (const std::string& name : FilesOf("out")) EXPECT_THAT(name, testing::Not(HasSubstr(".tmp")));
  EXPECT_FALSE(std::filesystem::exists(folder_ + "out/summary.json"));
}

// Children of a process, in the order of their start. Linux only.
std::vector<int> ChildrenOf(int process) {
  const std::string number = std::to_string(process);
  std::ifstream file("/proc/" + number + "/task/" + number + "/children");
  std::vector<int> children;
  for (int child = 0; file >> child;) children.push_back(child);
  return children;
}

TEST_F(SlamMpiTest, ALimitOfMemoryHoldsForTheResultsOfAll) {
  SimulateLog(60);
  const std::string flags = "--max_memory=32MB --picture_side_px=4000 --map_resolution_m=0.003";
  const Outcome one = Slam("a.clf", flags, "one");
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("pictures have sides of "));
  EXPECT_THAT(one.err, HasSubstr("those of map.pgm are "));
  const Outcome two = SlamMpi(2, "a.clf", flags, "two");
  ASSERT_EQ(two.exit_code, 0) << two.err;
  const auto size_of_map = [&](const std::string& folder) {
    return Result(folder, "map.pgm").substr(0, 12);
  };
  EXPECT_EQ(size_of_map("two"), size_of_map("one"));
}

TEST_F(SlamMpiTest, AProcessThatIsKilledEndsTheOthers) {
  SimulateLog(700);
  for (const std::size_t victim : {0, 1}) {
    SCOPED_TRACE(victim);
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    setenv("OMPI_MCA_odls_base_sigkill_timeout", "0", 1);
    RunningProgram run(
        {PLUMBLINE_MPIRUN, "--oversubscribe", "-n", "2", PLUMBLINE_PROGRAMS_DIR "/" + kName,
         "--log=" + folder_ + "a.clf", "--output_dir=" + folder_ + "out", "--threads=1"},
        folder_ + "printed");
    ASSERT_TRUE(run.Prints("Seeding: done"));
    const std::vector<int> children = ChildrenOf(run.process());
    ASSERT_EQ(children.size(), 2u);
    kill(children[victim], SIGKILL);
    ASSERT_TRUE(run.EndsWithin(30.0));
    EXPECT_NE(run.Wait(), 0);
    EXPECT_FALSE(std::filesystem::exists(folder_ + "out/summary.json"));
  }
  ASSERT_EQ(SlamMpi(2, "a.clf", "--max_scans=60").exit_code, 0);
  EXPECT_EQ(FilesOf("out"), kResults);  // what was half-written is gone
}

#else

TEST(SlamMpiTest, IsNotBuilt) { GTEST_SKIP() << "MPI or PETSc is not installed"; }

#endif

}  // namespace
}  // namespace plumbline
