#include "plumbline/solvers/full/nonlinear_cg.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>
#include <string>
#include <vector>

#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

using Vector = std::vector<double>;

Eigen::Map<const Eigen::VectorXd> AsEigen(const Vector& v) {
  return {v.data(), static_cast<Eigen::Index>(v.size())};
}

/// x^T A x / 2 - b^T x + offset, preconditioned with a given P^-1.
class Quadratic : public CgObjective {
 public:
  Quadratic(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) : a_(a), b_(b) {
    inverse_ = Eigen::MatrixXd::Identity(a.rows(), a.cols());
  }
  void SetPreconditioner(const Eigen::MatrixXd& inverse) { inverse_ = inverse; }
  void SetOffset(double offset) { offset_ = offset; }

  bool Evaluate(const Vector& x, double* cost, Vector* gradient) override {
    const Eigen::VectorXd g = a_ * AsEigen(x) - b_;
    *cost = 0.5 * AsEigen(x).dot(g - b_) + offset_;
    gradient->assign(g.data(), g.data() + g.size());
    return true;
  }
  bool Start(const Vector& x, double* cost, Vector* gradient) override {
    return Evaluate(x, cost, gradient);
  }
  double Curvature(const Vector&, const Vector& d) override {
    return AsEigen(d).dot(a_ * AsEigen(d));
  }
  void Precondition(const Vector& /*x*/, const Vector& gradient, Vector* result) override {
    const Eigen::VectorXd p = inverse_ * AsEigen(gradient);
    result->assign(p.data(), p.data() + p.size());
  }

 private:
  Eigen::MatrixXd a_, inverse_;
  Eigen::VectorXd b_;
  double offset_ = 0.0;
};

/// f(x) of one variable with its derivatives; undefined where f is NaN.
class Univariate : public CgObjective {
 public:
  using Function = double (*)(double);
  Univariate(Function f, Function slope, Function curvature)
      : f_(f), slope_(slope), curvature_(curvature) {}

  bool Evaluate(const Vector& x, double* cost, Vector* gradient) override {
    *cost = f_(x[0]);
    *gradient = {slope_(x[0])};
    return !std::isnan(*cost);
  }
  bool Start(const Vector& x, double* cost, Vector* gradient) override {
    return Evaluate(x, cost, gradient);
  }
  double Curvature(const Vector& x, const Vector& d) override {
    return curvature_(x[0]) * d[0] * d[0];
  }
  void Precondition(const Vector& /*x*/, const Vector& gradient, Vector* result) override {
    *result = gradient;
  }

 private:
  Function f_, slope_, curvature_;
};

/// Rosenbrock's valley (1 - x)^2 + 100 (y - x^2)^2 as a sum of squares, with Gauss-Newton
/// curvature.
class Rosenbrock : public CgObjective {
 public:
  bool Evaluate(const Vector& x, double* cost, Vector* gradient) override {
    const double r1 = 1.0 - x[0], r2 = 10.0 * (x[1] - x[0] * x[0]);
    *cost = r1 * r1 + r2 * r2;
    *gradient = {-2.0 * r1 - 40.0 * x[0] * r2, 20.0 * r2};
    return true;
  }
  bool Start(const Vector& x, double* cost, Vector* gradient) override {
    return Evaluate(x, cost, gradient);
  }
  double Curvature(const Vector& x, const Vector& d) override {
    const double j2 = 10.0 * d[1] - 20.0 * x[0] * d[0];
    return 2.0 * (d[0] * d[0] + j2 * j2);
  }
  void Precondition(const Vector& /*x*/, const Vector& gradient, Vector* result) override {
    *result = gradient;
  }
};

/// n x n with eigenvalues 1 to `condition`, geometric, along random directions.
Eigen::MatrixXd RandomSpd(int n, double condition) {
  RandomStates random(3);
  const Eigen::MatrixXd noise =
      Eigen::MatrixXd::NullaryExpr(n, n, [&random] { return random.Gaussian(1.0); });
  const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(noise).householderQ();
  const Eigen::VectorXd eigenvalues =
      Eigen::VectorXd::NullaryExpr(n, [&](int i) { return std::pow(condition, i / (n - 1.0)); });
  return q * eigenvalues.asDiagonal() * q.transpose();
}

NonlinearCgOptions Exhaustive(int max_iterations) {
  NonlinearCgOptions options;
  options.max_iterations = max_iterations;
  options.relative_cost_tolerance = 0.0;
  return options;
}

CgResult Minimize(const NonlinearCgOptions& options, CgObjective* objective, Vector* x,
                  const CgCallback& callback = nullptr) {
  ThreadPool pool(1);
  return MinimizeByCg(options, objective, callback, &pool, x);
}

TEST(NonlinearCgTest, SolvesAQuadraticInAsManyStepsAsItHasVariables) {
  // beta rises far above 1 on the way. At a condition of 1e4, rounding costs the textbook's method
  // some of its conjugacy, and a few more steps.
  constexpr int kSize = 10;
  const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(kSize, -1.0, 2.0);
  const auto error_after = [&](int steps, double condition) {
    const Eigen::MatrixXd a = RandomSpd(kSize, condition);
    Quadratic objective(a, a * expected);
    Vector x(kSize, 0.0);
    const CgResult result = Minimize(Exhaustive(steps), &objective, &x);
    EXPECT_LE(result.iterations, steps);
    return (AsEigen(x) - expected).norm() / expected.norm();
  };
  EXPECT_LE(error_after(kSize, 1e2), 1e-6);
  EXPECT_LE(error_after(kSize + kSize / 2, 1e4), 1e-6);
}

TEST(NonlinearCgTest, BothFormulasAgreeOnAQuadratic) {
  const Eigen::MatrixXd a = RandomSpd(8, 1e2);
  const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(8, -1.0, 2.0);
  Vector results[2];
  for (const CgFormula formula : {CgFormula::kFletcherReeves, CgFormula::kPolakRibiere}) {
    Quadratic objective(a, a * expected);
    NonlinearCgOptions options = Exhaustive(5);
    options.formula = formula;
    Vector& x = results[static_cast<int>(formula)];
    x.assign(8, 0.0);
    EXPECT_EQ(Minimize(options, &objective, &x).iterations, 5);
  }
  EXPECT_LE((AsEigen(results[0]) - AsEigen(results[1])).norm(), 1e-9);
  EXPECT_GE((AsEigen(results[0]) - expected).norm(), 1e-6);
}

TEST(NonlinearCgTest, GoesOnFromItsMemoryAsIfItHadNotStopped) {
  const Eigen::MatrixXd a = RandomSpd(8, 1e2);
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(8, -1.0, 2.0);
  Quadratic objective(a, b);
  Vector at_once(8, 0.0), bit_by_bit(8, 0.0);
  EXPECT_EQ(Minimize(Exhaustive(6), &objective, &at_once).iterations, 6);
  ThreadPool pool(1);
  CgMemory memory;
  for (int i = 0; i < 6; ++i) {
    double beta = 0.0;
    MinimizeByCg(
        Exhaustive(1), &objective,
        [&](const CgIteration& iteration) {
          beta = iteration.beta;
          return true;
        },
        &pool, &bit_by_bit, &memory);
    EXPECT_EQ(beta > 0.0, i > 0) << i;
  }
  EXPECT_EQ(at_once, bit_by_bit);
}

TEST(NonlinearCgTest, SolvesAQuadraticInOneStepWithItsInverse) {
  const Eigen::MatrixXd a = RandomSpd(10, 1e4);
  const Eigen::VectorXd expected = Eigen::VectorXd::LinSpaced(10, -1.0, 2.0);
  Quadratic objective(a, a * expected);
  objective.SetPreconditioner(a.inverse());
  NonlinearCgOptions options;
  options.max_iterations = 1;
  Vector x(10, 0.0);
  Minimize(options, &objective, &x);
  EXPECT_LE((AsEigen(x) - expected).norm(), 1e-9 * expected.norm());
}

TEST(NonlinearCgTest, AgreesWithADirectSolutionOfFilipsKind) {
  // A polynomial of degree 5 fitted to 40 samples: the normal equations' condition is 4e6.
  Eigen::MatrixXd design(40, 6);
  Eigen::VectorXd y(40);
  RandomStates random(9);
  for (int i = 0; i < 40; ++i) {
    const double t = i / 39.0;
    for (int k = 0; k < 6; ++k) design(i, k) = std::pow(t, k);
    y[i] = std::sin(4.0 * t) + random.Gaussian(0.1);
  }
  const Eigen::VectorXd direct = design.colPivHouseholderQr().solve(y);
  const Eigen::MatrixXd normal = design.transpose() * design;
  Quadratic objective(normal, design.transpose() * y);
  objective.SetOffset(0.5 * y.squaredNorm());
  objective.SetPreconditioner(normal.diagonal().cwiseInverse().asDiagonal());
  Vector x(6, 0.0);
  const CgResult result = Minimize(Exhaustive(2000), &objective, &x);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(x[k], direct[k], 1e-6 * direct.norm());
  EXPECT_NEAR(result.cost, 0.5 * (design * direct - y).squaredNorm(), 1e-9 * result.cost);
}

TEST(NonlinearCgTest, FollowsRosenbrocksValleyAndNeverRises) {
  Rosenbrock objective;
  Vector x = {-1.2, 1.0};
  double previous = 24.2;  // at the start
  int calls = 0;
  const CgResult result = Minimize(Exhaustive(5000), &objective, &x, [&](const CgIteration& it) {
    EXPECT_LE(it.cost, previous);
    EXPECT_DOUBLE_EQ(it.cost_change, previous - it.cost);
    EXPECT_GT(it.step_size, 0.0);
    EXPECT_GT(it.step_norm, 0.0);
    EXPECT_GE(it.beta, 0.0);
    EXPECT_GE(it.evaluations, 1);
    previous = it.cost;
    ++calls;
    return true;
  });
  EXPECT_EQ(result.cost, previous);
  EXPECT_EQ(result.iterations, calls);
  EXPECT_GT(result.restarts, 0);
  EXPECT_NEAR(x[0], 1.0, 1e-6);
  EXPECT_NEAR(x[1], 1.0, 1e-6);
}

TEST(NonlinearCgTest, StopsWhenTheCostHasConverged) {
  const Eigen::MatrixXd a = RandomSpd(10, 1e2);
  Quadratic objective(a, Eigen::VectorXd::Ones(10));
  NonlinearCgOptions options = Exhaustive(1000);
  options.relative_cost_tolerance = 0.1;
  Vector x(10, 0.0);
  double last_change = 0.0, last_cost = 0.0;
  const CgResult result = Minimize(options, &objective, &x, [&](const CgIteration& it) {
    last_change = it.cost_change;
    last_cost = it.cost;
    return true;
  });
  // The minimum is negative: the tolerance is relative to the size of the cost.
  EXPECT_LT(last_cost, 0.0);
  EXPECT_EQ(result.termination, CgTermination::kCostConverged);
  EXPECT_LE(last_change, 0.1 * std::abs(last_cost));
  EXPECT_LT(result.iterations, 10);
}

TEST(NonlinearCgTest, StopsWhereTheGradientVanishes) {
  Quadratic objective(Eigen::Matrix2d::Identity(), Eigen::Vector2d(3.0, 4.0));
  const NonlinearCgOptions options = Exhaustive(100);
  Vector x = {3.0, 4.0};
  CgResult result = Minimize(options, &objective, &x);
  EXPECT_EQ(result.termination, CgTermination::kGradientConverged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.cost, -12.5);
  EXPECT_EQ(x, Vector({3.0, 4.0}));
  x = {0.0, 0.0};
  result = Minimize(options, &objective, &x);
  EXPECT_EQ(result.termination, CgTermination::kGradientConverged);
  EXPECT_EQ(result.iterations, 1);
}

TEST(NonlinearCgTest, StopsAtTheLimitOfIterations) {
  Rosenbrock objective;
  Vector x = {-1.2, 1.0};
  const CgResult result = Minimize(Exhaustive(3), &objective, &x);
  EXPECT_EQ(result.termination, CgTermination::kMaxIterations);
  EXPECT_EQ(result.iterations, 3);
}

TEST(NonlinearCgTest, StopsWhenTheCallbackSaysSo) {
  Rosenbrock objective;
  Vector x = {-1.2, 1.0};
  int calls = 0;
  const CgResult result =
      Minimize(Exhaustive(100), &objective, &x, [&](const CgIteration&) { return ++calls < 2; });
  EXPECT_EQ(result.termination, CgTermination::kStopped);
  EXPECT_EQ(result.iterations, 2);
  Vector gradient;
  double cost = 0.0;
  objective.Evaluate(x, &cost, &gradient);
  EXPECT_EQ(result.cost, cost);
}

TEST(NonlinearCgTest, GivesUpWhereNoStepDescends) {
  const auto square = [](double x) { return x * x; };
  const auto two = [](double) { return 2.0; };
  // A gradient of the wrong sign, a curvature of the wrong sign, a gradient that is not a number.
  Univariate wrong_gradient(
      square, [](double x) { return -2.0 * x; }, two);
  Univariate wrong_curvature(
      square, [](double x) { return 2.0 * x; }, [](double) { return -2.0; });
  Univariate no_gradient(
      square, [](double) { return kNaN; }, two);
  for (Univariate* objective : {&wrong_gradient, &wrong_curvature, &no_gradient}) {
    Vector x = {1.5};
    const CgResult result = Minimize(NonlinearCgOptions(), objective, &x);
    EXPECT_EQ(result.termination, CgTermination::kNoDescent);
    EXPECT_EQ(result.iterations, 0);
    EXPECT_EQ(result.cost, 2.25);
    EXPECT_EQ(x, Vector({1.5}));
  }
}

TEST(NonlinearCgTest, FailsWhereTheFunctionIsUndefinedAtTheStart) {
  Univariate objective([](double) { return kNaN; }, [](double) { return 1.0; },
                       [](double) { return 1.0; });
  Vector x = {1.0};
  const CgResult result = Minimize(NonlinearCgOptions(), &objective, &x);
  EXPECT_EQ(result.termination, CgTermination::kFailure);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(x, Vector({1.0}));
}

TEST(NonlinearCgTest, HalvesAStepThatLeavesTheDomain) {
  // x - log x is undefined below 0. At x = 3 Newton's step (slope 2/3, curvature 1/9) is -6; its
  // half ends at 0, and a quarter of it at 1.5.
  Univariate objective([](double x) { return x > 0.0 ? x - std::log(x) : kNaN; },
                       [](double x) { return 1.0 - 1.0 / x; },
                       [](double x) { return 1.0 / (x * x); });
  Vector x = {3.0};
  int first_evaluations = 0;
  const CgResult result =
      Minimize(NonlinearCgOptions(), &objective, &x, [&](const CgIteration& it) {
        if (first_evaluations == 0) first_evaluations = it.evaluations;
        return true;
      });
  EXPECT_EQ(first_evaluations, 3);
  EXPECT_NE(result.termination, CgTermination::kFailure);
  EXPECT_NEAR(x[0], 1.0, 1e-4);
}

TEST(NonlinearCgTest, AnyNumberOfThreadsGivesTheSameBits) {
  // A chain of springs, long enough to be shared between threads.
  class Chain : public CgObjective {
   public:
    bool Evaluate(const Vector& x, double* cost, Vector* gradient) override {
      gradient->assign(x.size(), 0.0);
      *cost = 0.0;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const double e = x[i] - (i > 0 ? 0.9 * x[i - 1] : 0.0) - 0.01 * (i % 7);
        *cost += 0.5 * e * e;
        (*gradient)[i] += e;
        if (i > 0) (*gradient)[i - 1] -= 0.9 * e;
      }
      return true;
    }
    bool Start(const Vector& x, double* cost, Vector* gradient) override {
      return Evaluate(x, cost, gradient);
    }
    double Curvature(const Vector&, const Vector& d) override {
      double sum = d[0] * d[0];
      for (std::size_t i = 1; i < d.size(); ++i) sum += std::pow(d[i] - 0.9 * d[i - 1], 2);
      return sum;
    }
    void Precondition(const Vector& /*x*/, const Vector& gradient, Vector* result) override {
      *result = gradient;
    }
  };
  Vector one;
  for (const int num_threads : {1, 2, 3, 8}) {
    Chain objective;
    Vector x(100000, 0.0);
    ThreadPool pool(num_threads);
    const CgResult result = MinimizeByCg(Exhaustive(10), &objective, nullptr, &pool, &x);
    EXPECT_EQ(result.iterations, 10);
    if (num_threads == 1) one = x;
    EXPECT_EQ(x, one) << num_threads;
  }
}

TEST(NonlinearCgTest, ChecksItsOptions) {
  std::string error;
  NonlinearCgOptions options;
  EXPECT_TRUE(options.Check(&error)) << error;
  options.relative_cost_tolerance = kNaN;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_NE(error.find("relative_cost_tolerance"), std::string::npos) << error;
  options = NonlinearCgOptions();
  options.max_iterations = 0;
  EXPECT_FALSE(options.Check(&error));
  EXPECT_NE(error.find("max_iterations"), std::string::npos) << error;
}

}  // namespace
}  // namespace plumbline
