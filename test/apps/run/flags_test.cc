#include "plumbline/apps/run/flags.h"

#include <gflags/gflags.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/program/command_line.h"
#include "plumbline/solvers/interface/ceres_options.h"

namespace plumbline {
namespace {

using testing::HasSubstr;

struct AllOptions {
  SolverOptions solver;
  SeedingOptions seeding;
};

AllOptions FromFlags() {
  AllOptions options;
  EXPECT_TRUE(SolverOptionsFromFlags(&options.solver).ok());
  EXPECT_TRUE(SeedingOptionsFromFlags(&options.seeding).ok());
  return options;
}

// Where the number of a flag ends up, in the flag's unit.
struct NumberFlag {
  const char* name;
  double (*read)(const AllOptions&);
};

const std::vector<NumberFlag>& NumberFlags() {
  using O = const AllOptions&;
  static const std::vector<NumberFlag> flags = {
      {"threads", [](O o) { return double(o.solver.num_threads); }},
      {"sigma_range_m", [](O o) { return o.solver.factors.beam.sigma_range_m; }},
      {"sigma_bearing_rad", [](O o) { return o.solver.factors.beam.sigma_bearing_rad; }},
      {"sigma_manifold_m", [](O o) { return o.solver.factors.manifold.sigma_m; }},
      {"manifold_gate", [](O o) { return o.solver.factors.manifold.robust_gate_sigmas; }},
      {"landmark_size_m", [](O o) { return o.solver.association.landmark_size_m; }},
      {"coarse_rounds", [](O o) { return double(o.solver.rounds.max_coarse_rounds); }},
      {"fine_rounds", [](O o) { return double(o.solver.rounds.max_fine_rounds); }},
      {"reduced_max_rounds", [](O o) { return double(o.solver.reduced.max_rounds); }},
      {"reduced_tolerance", [](O o) { return o.solver.reduced.relative_tolerance; }},
      {"cg_max_sweeps", [](O o) { return double(o.solver.alternating_cg.max_sweeps); }},
      {"cg_scan_iterations",
       [](O o) { return double(o.solver.alternating_cg.scan_iterations_per_sweep); }},
      {"cg_tolerance", [](O o) { return o.solver.alternating_cg.relative_cost_tolerance; }},
      {"keyframe_distance_m", [](O o) { return o.seeding.keyframe_distance_m; }},
  };
  return flags;
}

void SetFlag(const std::string& name, const std::string& value) {
  ASSERT_FALSE(gflags::SetCommandLineOption(name.c_str(), value.c_str()).empty()) << name;
}

class FlagsTest : public testing::Test {
 private:
  gflags::FlagSaver saver_;
};

TEST_F(FlagsTest, DefaultsAreThoseOfTheLibrary) {
  const AllOptions library, flags = FromFlags();
  for (const NumberFlag& flag : NumberFlags()) {
    EXPECT_DOUBLE_EQ(flag.read(flags), flag.read(library)) << flag.name;
  }
  for (const CeresField& field : CeresFields()) {
    EXPECT_EQ(field.get(*flags.solver.ceres), field.get(*library.solver.ceres)) << field.name;
  }
  EXPECT_EQ(flags.solver.type, library.solver.type);
  EXPECT_EQ(flags.solver.ceres->reduced, library.solver.ceres->reduced);
  EXPECT_EQ(flags.solver.factors.shape, library.solver.factors.shape);
  for (const MotionField& field : kMotionFields) {
    EXPECT_EQ(flags.solver.factors.motion.*field.value, library.solver.factors.motion.*field.value);
  }
}

TEST_F(FlagsTest, EachNumberReachesItsOption) {
  for (const NumberFlag& flag : NumberFlags()) {
    const gflags::FlagSaver saver;
    const bool whole = gflags::GetCommandLineFlagInfoOrDie(flag.name).type == "int32";
    const double before = flag.read(AllOptions()), after = whole ? before + 1 : 1.25 * before;
    SetFlag(flag.name, std::to_string(after).substr(
                           0, whole ? std::to_string(after).find('.') : std::string::npos));
    EXPECT_NEAR(flag.read(FromFlags()), after, 1e-6) << flag.name;
    EXPECT_NE(flag.read(FromFlags()), before) << flag.name;
  }
}

TEST_F(FlagsTest, FieldsOfCeresAreSetByName) {
  SetFlag("ceres",
          "linear_solver_type=Dense_QR,eta=0.25,max_num_iterations=7,jacobi_scaling=false");
  const SolverOptions options = FromFlags().solver;
  EXPECT_EQ(options.ceres->linear_solver_type, ceres::DENSE_QR);
  EXPECT_EQ(options.ceres->eta, 0.25);
  EXPECT_EQ(options.ceres->max_num_iterations, 7);
  EXPECT_FALSE(options.ceres->jacobi_scaling);
  EXPECT_EQ(options.ceres->function_tolerance, CeresOptions().function_tolerance);
  EXPECT_THAT(GivenCeresFields(), testing::ElementsAre("linear_solver_type", "eta",
                                                       "max_num_iterations", "jacobi_scaling"));
}

TEST_F(FlagsTest, AWrongFieldOfCeresIsReportedWithWhatThereIs) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"eta", "--ceres=eta: want NAME=VALUE"},
      {"dogleg=x", "--ceres=dogleg=x: there is no option 'dogleg' of ceres; there are"},
      {"eta=1,dogleg_type=x",
       "--ceres=dogleg_type=x: dogleg_type = 'x', but it must be traditional_dogleg or"},
      {"max_num_iterations=2.5", "must be a whole number"},
      {"max_num_iterations=0",
       "--ceres=max_num_iterations=0: max_num_iterations = 0, but it must be >= 1"},
      {"jacobi_scaling=1", "must be true or false"},
      {"eta=nan", "must be a finite number"},
      {"eta=", "eta = '', but it must be a finite number"}};
  for (const auto& [value, message] : cases) {
    SetFlag("ceres", value);
    SolverOptions options;
    EXPECT_THAT(SolverOptionsFromFlags(&options).message(), HasSubstr(message)) << value;
  }
}

TEST_F(FlagsTest, FieldsOfTheOdometryNoiseAreSetByName) {
  SetFlag("odometry_noise", "translation_floor_m=0.25,rotation_per_rotation=1e-3");
  const MotionOptions motion = FromFlags().solver.factors.motion;
  EXPECT_EQ(motion.translation_floor_m, 0.25);
  EXPECT_EQ(motion.rotation_per_rotation, 1e-3);
  EXPECT_EQ(motion.rotation_floor_rad, MotionOptions().rotation_floor_rad);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"0.1", "--odometry_noise=0.1: want NAME=VALUE"},
      {"alpha=1", "--odometry_noise=alpha=1: there is no such noise"},
      {"translation_floor_m=1cm", "field 'translation_floor_m': '1cm' is not a number"},
      {"translation_floor_m=nan",
       "--odometry_noise=translation_floor_m=nan: translation_floor_m = nan"},
      {"translation_floor_m=", "field 'translation_floor_m': is missing"}};
  for (const auto& [value, message] : cases) {
    SetFlag("odometry_noise", value);
    SolverOptions options;
    EXPECT_THAT(SolverOptionsFromFlags(&options).message(), HasSubstr(message)) << value;
  }
}

TEST_F(FlagsTest, OurOwnNamesAndSwitches) {
  const SolverOptions defaults;
  SetFlag("shape", "true");
  SetFlag("test_edges", "false");
  SetFlag("reduced", "true");
  SetFlag("published_sigma_from_start", "true");
  for (const SolverType type : {SolverType::kCeres, SolverType::kPoseGraph, SolverType::kSgd}) {
    SetFlag("solver", ToString(type));
    EXPECT_EQ(FromFlags().solver.type, type);
  }
  const SolverOptions options = FromFlags().solver;
  EXPECT_NE(options.factors.shape, defaults.factors.shape);
  EXPECT_NE(options.test_edges, defaults.test_edges);
  EXPECT_NE(options.ceres->reduced, defaults.ceres->reduced);
  EXPECT_NE(options.published.sigma_from_start, defaults.published.sigma_from_start);
}

TEST_F(FlagsTest, TheStartIsTheSolversUnlessItIsSaid) {
  const auto start = [](SolverType type) {
    SolverOptions options;
    options.type = type;
    StartType start = StartType::kOdometry;
    EXPECT_TRUE(StartFromFlags(options, &start).ok());
    return start;
  };
  EXPECT_EQ(start(SolverType::kReduced), StartType::kSeed);
  EXPECT_EQ(start(SolverType::kPublished), StartType::kIcpGlobal);
  for (const StartType said : {StartType::kOdometry, StartType::kIcp, StartType::kIcpPointToLine,
                               StartType::kIcpGlobal, StartType::kSeed}) {
    SetFlag("start", ToString(said));
    EXPECT_EQ(start(SolverType::kReduced), said);
    EXPECT_EQ(start(SolverType::kPublished), said);
  }
}

// Those of flags.cc, among others that other sources share between programs.
std::vector<gflags::CommandLineFlagInfo> FlagsOfFlagsFile() {
  std::vector<gflags::CommandLineFlagInfo> flags;
  for (const gflags::CommandLineFlagInfo& flag : ProgramFlags()) {
    if (std::filesystem::path(flag.filename).filename() == "flags.cc") flags.push_back(flag);
  }
  return flags;
}

// A flag that these tests do not know may be one that nothing reads.
TEST_F(FlagsTest, EveryFlagIsTestedHere) {
  std::vector<std::string> known = {
      "solver", "start",      "reduced",        "ceres",
      "shape",  "test_edges", "odometry_noise", "published_sigma_from_start"};
  for (const NumberFlag& flag : NumberFlags()) known.emplace_back(flag.name);
  for (const gflags::CommandLineFlagInfo& flag : FlagsOfFlagsFile()) {
    EXPECT_TRUE(std::find(known.begin(), known.end(), flag.name) != known.end()) << flag.name;
  }
  EXPECT_EQ(FlagsOfFlagsFile().size(), known.size());
}

TEST_F(FlagsTest, AWrongNameIsReportedWithItsFlag) {
  for (const gflags::CommandLineFlagInfo& flag : FlagsOfFlagsFile()) {
    if (flag.type != "string") continue;
    const gflags::FlagSaver saver;
    SetFlag(flag.name, "nonsense");
    SolverOptions options;
    StartType start;
    const Status status =
        flag.name == "start" ? StartFromFlags(options, &start) : SolverOptionsFromFlags(&options);
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
    EXPECT_THAT(status.message(), HasSubstr("--" + flag.name + "=nonsense"));
  }
}

TEST_F(FlagsTest, AValueOutOfRangeIsReportedWithItsOption) {
  SolverOptions options;
  SetFlag("threads", "0");
  EXPECT_THAT(SolverOptionsFromFlags(&options).message(), HasSubstr("num_threads = 0"));
  SetFlag("threads", "1");
  SetFlag("sigma_range_m", "nan");
  EXPECT_THAT(SolverOptionsFromFlags(&options).message(), HasSubstr("sigma_range_m = nan"));
  SeedingOptions seeding;
  SetFlag("keyframe_distance_m", "-1");
  EXPECT_THAT(SeedingOptionsFromFlags(&seeding).message(), HasSubstr("keyframe_distance_m = -1"));
}

// Ceres' BFGS wants Wolfe's conditions.
TEST_F(FlagsTest, SwitchesThatCeresRefusesTogetherAreReported) {
  SetFlag("ceres",
          "minimizer_type=line_search,line_search_direction_type=bfgs,line_search_type=armijo");
  SolverOptions options;
  EXPECT_TRUE(SolverOptionsFromFlags(&options).ok());  // they do not matter to the other solver
  SetFlag("solver", "ceres");
  const Status status = SolverOptionsFromFlags(&options);
  EXPECT_EQ(status.code(), StatusCode::kInvalidArgument);
  EXPECT_THAT(status.message(), HasSubstr("WOLFE"));
}

std::string Refusal() { return CheckNoFlagIsIgnored(FromFlags().solver).message(); }

TEST_F(FlagsTest, AFlagThatTheSolverDoesNotReadIsRefused) {
  EXPECT_EQ(Refusal(), "");
  struct Case {
    const char* flag;
    std::vector<std::string> readers;
  };
  const std::vector<std::string> all = {"reduced",   "alternating_cg", "ceres", "ceres --reduced",
                                        "published", "pose_graph",     "sgd"};
  const std::vector<std::string> of_returns(all.begin(), all.begin() + 5);
  // The published method leaves no choice of these.
  const std::vector<std::string> with_choices(all.begin(), all.begin() + 4);
  const std::vector<std::string> in_rounds = {"alternating_cg", "ceres"};
  const std::vector<std::string> over_landmarks = {"reduced", "ceres --reduced"};
  const std::vector<std::string> by_ceres = {"ceres", "ceres --reduced"};
  const Case cases[] = {{"threads", all},
                        {"sigma_range_m", all},
                        {"sigma_manifold_m", of_returns},
                        {"test_edges", of_returns},
                        {"shape", with_choices},
                        {"manifold_gate", with_choices},
                        {"landmark_size_m", of_returns},
                        {"coarse_rounds", in_rounds},
                        {"published_sigma_from_start", {"published"}},
                        {"reduced_max_rounds", over_landmarks},
                        {"reduced_tolerance", over_landmarks},
                        {"ceres", by_ceres},
                        {"cg_max_sweeps", {"alternating_cg"}},
                        {"cg_tolerance", {"alternating_cg"}}};
  for (const Case& it : cases) {
    for (const std::string& solver : all) {
      const gflags::FlagSaver saver;
      SetFlag("solver", solver.substr(0, solver.find(' ')));
      if (solver == "ceres --reduced") SetFlag("reduced", "true");
      // The default said aloud asks for something, too.
      SetFlag(it.flag, gflags::GetCommandLineFlagInfoOrDie(it.flag).default_value);
      const bool is_read =
          std::find(it.readers.begin(), it.readers.end(), solver) != it.readers.end();
      EXPECT_EQ(Refusal(),
                is_read ? "" : "--" + std::string(it.flag) + " is ignored by --solver=" + solver);
    }
  }
}

TEST_F(FlagsTest, APlainStartReadsNoFlagsOfTheSeeding) {
  SetFlag("keyframe_distance_m", "0.5");
  const SolverOptions options = FromFlags().solver;
  EXPECT_TRUE(CheckNoFlagIsIgnored(options, StartType::kSeed).ok());
  EXPECT_EQ(CheckNoFlagIsIgnored(options, StartType::kIcp).message(),
            "--keyframe_distance_m is ignored by --start=icp");
  SetFlag("solver", "pose_graph");  // which has its edges from the seeding
  EXPECT_TRUE(CheckNoFlagIsIgnored(FromFlags().solver, StartType::kIcp).ok());
}

TEST_F(FlagsTest, TheReducedFormBelongsToCeres) {
  SetFlag("reduced", "true");
  for (const char* other : {"reduced", "alternating_cg"}) {
    SetFlag("solver", other);
    EXPECT_EQ(Refusal(), std::string("--reduced is ignored by --solver=") + other);
  }
  SetFlag("solver", "ceres");
  EXPECT_EQ(Refusal(), "");
}

TEST_F(FlagsTest, HelpListsOurFlagsOnly) {
  const std::string help = HelpText("Does this and that.");
  EXPECT_THAT(help, testing::StartsWith("Does this and that.\n"));
  EXPECT_THAT(help, HasSubstr("\n  --threads=2\n      Threads;"));
  EXPECT_THAT(help, HasSubstr("\n  --landmark_size_m=0.8\n"));
  EXPECT_THAT(help, testing::Not(HasSubstr("logtostderr")));
  EXPECT_THAT(help, testing::Not(HasSubstr("helpxml")));
}

}  // namespace
}  // namespace plumbline
