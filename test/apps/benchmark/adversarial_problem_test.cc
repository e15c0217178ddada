#include "plumbline/apps/benchmark/adversarial_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace plumbline {
namespace {

AdversarialProblem Make(Attack attack, double level, bool seeded = false) {
  AdversarialProblem problem;
  const Status status = MakeAdversarialProblem({attack, level, 2, seeded}, &problem);
  EXPECT_TRUE(status.ok()) << status.message();
  return problem;
}

double WorstStart(const AdversarialProblem& problem) {
  double worst = 0.0;
  for (int i = 0; i < problem.graph.num_poses(); ++i) {
    const Pose2 start = problem.graph.InitialPose(i);
    worst = std::max(worst, (start.translation() - problem.truth[i].translation()).norm());
  }
  return worst;
}

double Share(int count, int all) { return static_cast<double>(count) / all; }

TEST(AdversarialProblemTest, StartsWhereTheAttackSays) {
  EXPECT_EQ(WorstStart(Make(Attack::kTruth, 0.0)), 0.0);
  const double drift = WorstStart(Make(Attack::kNone, 0.0));
  EXPECT_GT(drift, 0.01);
  EXPECT_LT(drift, 0.3);
  EXPECT_NEAR(WorstStart(Make(Attack::kDrift, 3.0)), 3.0 * drift, 1e-9);
  EXPECT_GT(WorstStart(Make(Attack::kJump, 3.0)), 2.0);
  EXPECT_GT(WorstStart(Make(Attack::kShuffled, 0.1)), 2.0);
}

TEST(AdversarialProblemTest, ClosuresAreRightButForTheShareThatIsNot) {
  for (const double level : {0.0, 0.1, 1.0}) {
    const AdversarialProblem problem = Make(Attack::kWrongClosures, level);
    int wrong = 0;
    const auto& closures = problem.graph.relative_poses();
    for (const RelativePoseConstraint& closure : closures) {
      const Pose2 error = closure.from_from_to.Inverse() *
                          Between(problem.truth[closure.from], problem.truth[closure.to]);
      wrong += error.translation().norm() > 0.15 || std::abs(error.yaw) > 0.05 ? 1 : 0;
    }
    ASSERT_GT(closures.size(), 20u);
    EXPECT_NEAR(Share(wrong, static_cast<int>(closures.size())), level, 0.12);
  }
}

TEST(AdversarialProblemTest, ScansAreFalsifiedInTheShareAskedFor) {
  const AdversarialProblem clean = Make(Attack::kNone, 0.0);
  for (const Attack attack : {Attack::kMirrored, Attack::kRepeatedScan}) {
    const AdversarialProblem problem = Make(attack, 0.1);
    int changed = 0, total = clean.graph.num_scans();
    ASSERT_EQ(problem.graph.num_scans(), total);
    for (int s = 0; s < total; ++s) {
      const ScanEntry &a = clean.graph.scan(s), &b = problem.graph.scan(s);
      changed +=
          a.num_returns != b.num_returns || clean.graph.returns().range_m[a.first_return] !=
                                                problem.graph.returns().range_m[b.first_return]
              ? 1
              : 0;
    }
    EXPECT_NEAR(Share(changed, total), 0.1, 0.02) << ToString(attack);
  }
}

TEST(AdversarialProblemTest, PeopleShortenTheirShareOfTheReturns) {
  const AdversarialProblem clean = Make(Attack::kNone, 0.0);
  const AdversarialProblem people = Make(Attack::kPeople, 0.3);
  const LaserReturns &a = clean.graph.returns(), &b = people.graph.returns();
  double before = 0.0, after = 0.0;
  for (const double range : a.range_m) before += range / a.size();
  for (const double range : b.range_m) after += range / b.size();
  EXPECT_LT(after, 0.95 * before);
  EXPECT_GT(after, 0.7 * before);
}

TEST(AdversarialProblemTest, OdometryGoesMissingAndALogKeepsIt) {
  const int steps = Make(Attack::kNone, 0.0).graph.num_poses() - 1;
  const auto count = [](const AdversarialProblem& problem) {
    return static_cast<int>(problem.graph.odometry().size());
  };
  EXPECT_EQ(count(Make(Attack::kNone, 0.0)), steps);
  EXPECT_NEAR(Share(count(Make(Attack::kMissingOdometry, 0.5)), steps), 0.5, 0.1);
  EXPECT_EQ(count(Make(Attack::kMissingOdometry, 1.0)), 0);
  const AdversarialProblem log = Make(Attack::kNone, 0.0, true);
  EXPECT_EQ(count(log), steps);
  EXPECT_TRUE(log.graph.relative_poses().empty());
}

}  // namespace
}  // namespace plumbline
