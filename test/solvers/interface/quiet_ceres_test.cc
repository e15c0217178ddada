#include "plumbline/solvers/interface/quiet_ceres.h"

#include <ceres/iteration_callback.h>
#include <ceres/sized_cost_function.h>
#include <glog/logging.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "plumbline/test/core/captured_output.h"

namespace plumbline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char kWarning[] = "Error in evaluating the ResidualBlock";

// The residual x - 1, after `on_evaluation`; not a number if `is_broken`.
class Residual final : public ceres::SizedCostFunction<1, 1> {
 public:
  Residual(bool is_broken, std::function<void()> on_evaluation)
      : is_broken_(is_broken), on_evaluation_(std::move(on_evaluation)) {}

  bool Evaluate(double const* const* x, double* residuals, double** jacobians) const override {
    if (on_evaluation_) on_evaluation_();
    residuals[0] = is_broken_ ? std::numeric_limits<double>::quiet_NaN() : x[0][0] - 1.0;
    if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = 1.0;
    return true;
  }

 private:
  bool is_broken_;
  std::function<void()> on_evaluation_;
};

class Callback final : public ceres::IterationCallback {
 public:
  explicit Callback(std::function<void()> function,
                    ceres::CallbackReturnType result = ceres::SOLVER_CONTINUE)
      : function_(std::move(function)), result_(result) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary&) override {
    function_();
    return result_;
  }

 private:
  std::function<void()> function_;
  ceres::CallbackReturnType result_;
};

struct Problem {
  explicit Problem(bool is_broken, std::function<void()> on_evaluation = nullptr) {
    problem.AddResidualBlock(new Residual(is_broken, std::move(on_evaluation)), nullptr, &x);
  }
  void SolveQuietly() { plumbline::SolveQuietly(options, &problem, &summary); }

  double x = 0.0;
  ceres::Problem problem;
  ceres::Solver::Options options;
  ceres::Solver::Summary summary;
};

void SolveBrokenProblem() { Problem(true).SolveQuietly(); }

class QuietCeresTest : public testing::Test {
 protected:
  void TearDown() override {
    FLAGS_minloglevel = google::GLOG_INFO;
    FLAGS_logtostderr = false;
  }
};

TEST_F(QuietCeresTest, SuppressesWhatCeresLogsWhenToldToBeSilent) {
  Problem loud(true);
  loud.options.logging_type = ceres::SILENT;
  const std::string warning =
      CapturedOutput([&] { ceres::Solve(loud.options, &loud.problem, &loud.summary); });
  EXPECT_THAT(warning, HasSubstr(kWarning));

  Problem quiet(true);
  EXPECT_EQ(CapturedOutput([&] { quiet.SolveQuietly(); }), "");
  EXPECT_EQ(quiet.summary.termination_type, ceres::FAILURE);
  EXPECT_EQ(quiet.summary.message, loud.summary.message);
}

TEST_F(QuietCeresTest, SolvesAsCeresDoes) {
  Problem expected(false), quiet(false);
  expected.options.logging_type = ceres::SILENT;
  ceres::Solve(expected.options, &expected.problem, &expected.summary);
  EXPECT_EQ(CapturedOutput([&] { quiet.SolveQuietly(); }), "");
  EXPECT_EQ(quiet.x, expected.x);
  EXPECT_NEAR(quiet.x, 1.0, 1e-6);
  EXPECT_EQ(quiet.summary.iterations.size(), expected.summary.iterations.size());
}

TEST_F(QuietCeresTest, GivesTheHostItsLevelBack) {
  for (const int level : {-1, 0, 1, 2, 3, 4}) {
    FLAGS_minloglevel = level;
    int level_inside = -1;
    Problem problem(true, [&] { level_inside = FLAGS_minloglevel; });
    EXPECT_EQ(CapturedOutput([&] { problem.SolveQuietly(); }), "");
    EXPECT_EQ(level_inside, std::max<int>(level, google::GLOG_FATAL));
    EXPECT_EQ(FLAGS_minloglevel, level);
  }
  FLAGS_minloglevel = google::GLOG_INFO;
  EXPECT_THAT(CapturedOutput([] { LOG(INFO) << "of the host"; }), HasSubstr("of the host"));
}

TEST_F(QuietCeresTest, LeavesALevelThatTheHostSetsInTheMeantime) {
  Problem inside_ceres(false, [] { FLAGS_minloglevel = google::GLOG_WARNING; });
  inside_ceres.SolveQuietly();
  EXPECT_EQ(FLAGS_minloglevel, google::GLOG_WARNING);

  Callback callback([] { FLAGS_minloglevel = google::GLOG_ERROR; });
  Problem in_callback(false);
  in_callback.options.callbacks.push_back(&callback);
  in_callback.SolveQuietly();
  EXPECT_EQ(FLAGS_minloglevel, google::GLOG_ERROR);
}

TEST_F(QuietCeresTest, TheHostLogsInItsCallback) {
  Problem problem(false, [] { LOG(WARNING) << "in the residual"; });
  Callback callback([] { LOG(WARNING) << "in the callback"; });
  problem.options.callbacks.push_back(&callback);
  EXPECT_THAT(CapturedOutput([&] { problem.SolveQuietly(); }),
              AllOf(HasSubstr("in the callback"), Not(HasSubstr("in the residual"))));
  EXPECT_EQ(FLAGS_minloglevel, google::GLOG_INFO);
}

TEST_F(QuietCeresTest, EveryCallbackLogsAndMayStopTheSolve) {
  Callback first([] { LOG(WARNING) << "the first"; });
  Callback second([] { LOG(WARNING) << "the second"; }, ceres::SOLVER_TERMINATE_SUCCESSFULLY);
  Problem problem(false);
  problem.options.callbacks = {&first, &second};
  EXPECT_THAT(CapturedOutput([&] { problem.SolveQuietly(); }),
              AllOf(HasSubstr("the first"), HasSubstr("the second")));
  EXPECT_EQ(problem.summary.termination_type, ceres::USER_SUCCESS);
  EXPECT_EQ(problem.summary.iterations.size(), 1u);
}

TEST_F(QuietCeresTest, RestoresTheLevelWhenTheHostThrows) {
  const auto fail = [] { throw std::runtime_error("of the host"); };
  Problem in_residual(false, fail);
  EXPECT_THROW(in_residual.SolveQuietly(), std::runtime_error);
  EXPECT_EQ(FLAGS_minloglevel, google::GLOG_INFO);

  Callback callback(fail);
  Problem in_callback(false);
  in_callback.options.callbacks.push_back(&callback);
  EXPECT_THROW(in_callback.SolveQuietly(), std::runtime_error);
  EXPECT_EQ(FLAGS_minloglevel, google::GLOG_INFO);
}

TEST_F(QuietCeresTest, SolvesOfSeveralThreadsRestoreTheLevelOnce) {
  FLAGS_minloglevel = google::GLOG_WARNING;
  const std::string output = CapturedOutput([] {
    std::vector<std::thread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([] {
        Callback callback([] {});
        for (int k = 0; k < 50; ++k) {
          SolveBrokenProblem();
          Problem sound(false);
          sound.options.callbacks.push_back(&callback);
          sound.SolveQuietly();
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
  });
  EXPECT_EQ(output, "");
  EXPECT_EQ(FLAGS_minloglevel, google::GLOG_WARNING);
}

TEST_F(QuietCeresTest, OneThatStartsInsideAnotherRestoresNothing) {
  Problem outer(true, [] {
    SolveBrokenProblem();
    LOG(WARNING) << "inside the outer solve";
  });
  EXPECT_EQ(CapturedOutput([&] { outer.SolveQuietly(); }), "");
  EXPECT_EQ(FLAGS_minloglevel, google::GLOG_INFO);
}

TEST_F(QuietCeresTest, LeavesAnInitializedGlogAlone) {
  FLAGS_logtostderr = true;  // no log files
  google::InitGoogleLogging("host");
  Problem problem(true, [] {
    EXPECT_EQ(FLAGS_minloglevel, google::GLOG_INFO);
    LOG(INFO) << "of the host";
  });
  EXPECT_THAT(CapturedOutput([&] { problem.SolveQuietly(); }),
              AllOf(HasSubstr("of the host"), HasSubstr(kWarning)));
  google::ShutdownGoogleLogging();
}

TEST_F(QuietCeresTest, GlogMayBeInitializedInACallback) {
  FLAGS_logtostderr = true;
  bool is_initialized = false;
  Callback callback([&] {
    if (!is_initialized) google::InitGoogleLogging("host");
    is_initialized = true;
  });
  Problem problem(false, [&] { LOG(INFO) << (is_initialized ? "after it" : "before it"); });
  problem.options.callbacks.push_back(&callback);
  EXPECT_THAT(CapturedOutput([&] { problem.SolveQuietly(); }),
              AllOf(HasSubstr("after it"), Not(HasSubstr("before it"))));
  google::ShutdownGoogleLogging();
  EXPECT_EQ(FLAGS_minloglevel, google::GLOG_INFO);
}

TEST(QuietCeresDeathTest, FatalLinesStillComeOut) {
  Problem problem(false, [] { LOG(FATAL) << "fatal to the host"; });
  EXPECT_DEATH(problem.SolveQuietly(), "fatal to the host");
}

}  // namespace
}  // namespace plumbline
