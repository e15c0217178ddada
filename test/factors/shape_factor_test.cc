#include "plumbline/factors/shape_factor.h"

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "plumbline/core/angle.h"
#include "plumbline/test/factors/factor_testing.h"

namespace plumbline {
namespace {

constexpr ShapeCategory kCategories[] = {ShapeCategory::k0, ShapeCategory::k90, ShapeCategory::k180,
                                         ShapeCategory::k270};

double AngleOf(ShapeCategory category) { return static_cast<int>(category) * kPi / 2.0; }

Eigen::Vector2d Turned(double angle_rad, const Eigen::Vector2d& v) {
  return Eigen::Rotation2Dd(angle_rad) * v;
}

// n* - R_k n as the model states it, turned by R_k^T at the end to compare entry by entry.
struct Twin {
  ShapeCategory category;
  double sigma_rad;

  template <typename T>
  static Eigen::Matrix<T, 2, 1> Normal(const T* previous, const T* current) {
    using std::sqrt;
    const Eigen::Matrix<T, 2, 1> d(previous[0] - current[0], previous[1] - current[1]);
    return Eigen::Rotation2Dd(kPi / 2.0).toRotationMatrix().cast<T>() * d / sqrt(d.squaredNorm());
  }
  template <typename T>
  bool operator()(const T* previous, const T* current, const T* adjacent_previous,
                  const T* adjacent_current, T* residuals) const {
    const Eigen::Matrix<T, 2, 2> r =
        Eigen::Rotation2Dd(AngleOf(category)).toRotationMatrix().cast<T>();
    Eigen::Map<Eigen::Matrix<T, 2, 1>> result(residuals);
    result = r.transpose() *
             (Normal(adjacent_previous, adjacent_current) - r * Normal(previous, current)) /
             T(sigma_rad);
    return true;
  }
};

ShapeFactor FactorOf(ShapeCategory category, double sigma_rad) {
  return ShapeFactor(ShapeResidual{category, 1.0 / sigma_rad});
}

// The ends of a segment with this normal.
Blocks SegmentWithNormal(const Eigen::Vector2d& normal, double length) {
  const Eigen::Vector2d previous(0.7, -0.4);
  return {ToBlock(previous),
          ToBlock(Eigen::Vector2d(previous - length * Turned(-kPi / 2.0, normal)))};
}

Blocks Joined(Blocks segment, const Blocks& adjacent) {
  segment.insert(segment.end(), adjacent.begin(), adjacent.end());
  return segment;
}

TEST(ShapeFactor, HasTheHandWorkedValue) {
  // d = (0, 2), n = (-1, 0); turned by 270 deg n becomes (0, 1). d* = (8, -6), n* = (0.6, 0.8). So
  // n* - R n = (0.6, -0.2), and turned back by 270 deg (0.2, 0.6).
  ExpectResiduals(FactorOf(ShapeCategory::k270, 0.5),
                  {{1.0, 3.0}, {1.0, 1.0}, {9.0, 1.0}, {1.0, 7.0}}, {0.4, 1.2});
}

TEST(ShapeFactor, IsZeroAtEveryRightAngle) {
  RandomStates random(5);
  for (const ShapeCategory category : kCategories) {
    const Eigen::Vector2d previous = random.Pose().translation(),
                          current = random.Pose().translation();
    const Eigen::Vector2d adjacent = Turned(AngleOf(category), SegmentNormal(previous, current));
    ExpectResiduals(FactorOf(category, 0.01),
                    Joined({ToBlock(previous), ToBlock(current)}, SegmentWithNormal(adjacent, 0.3)),
                    {0.0, 0.0});
  }
}

TEST(ShapeFactor, ObeysTheFactorLaws) {
  for (const double length : {0.02, 0.2, 3.0}) {
    for (const ShapeCategory category : kCategories) {
      ExpectFactorLaws(FactorOf(category, 0.1),
                       ceres::AutoDiffCostFunction<Twin, 2, 2, 2, 2, 2>(new Twin{category, 0.1}),
                       [length](RandomStates* random) -> Blocks {
                         const auto segment = [&]() -> Blocks {
                           const Eigen::Vector2d previous = 0.5 * random->Pose().translation();
                           return {
                               ToBlock(previous),
                               ToBlock(Eigen::Vector2d(previous - length * random->Direction()))};
                         };
                         const Blocks first = segment();
                         return Joined(first, segment());
                       });
    }
  }
}

// Adjacent normals exactly parallel, orthogonal and opposite to the segment's: n = (0, 1).
TEST(ShapeFactor, HasCorrectGradientsAtRightAngles) {
  for (const ShapeCategory category : kCategories) {
    for (const Eigen::Vector2d& adjacent :
         {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)}) {
      ExpectGradientsCorrect(FactorOf(category, 0.1),
                             Joined({{1.5, 0.3}, {0.5, 0.3}}, SegmentWithNormal(adjacent, 0.4)));
    }
  }
}

TEST(ShapeFactor, DerivativeOfTheNormalHasItsClosedForm) {
  Eigen::Matrix2d m;
  m << 0.0, -1.0, 1.0, 0.0;
  RandomStates random(11);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d previous = random.Pose().translation(),
                          current = random.Pose().translation();
    const Eigen::Vector2d n = SegmentNormal(previous, current);
    const Eigen::Matrix2d d_normal =
        (Eigen::Matrix2d::Identity() - n * n.transpose()) * m / (previous - current).norm();
    // With sigma = 1 the residual is n* - n.
    const Blocks segment = {ToBlock(previous), ToBlock(current)};
    const FactorEvaluation at =
        Evaluate(FactorOf(ShapeCategory::k0, 1.0), Joined(segment, {{1, 0}, {0, 2}}));
    EXPECT_LT((-at.jacobians[0] - d_normal).norm(), 1e-12 * (1.0 + d_normal.norm()));
    EXPECT_LT((-at.jacobians[1] + d_normal).norm(), 1e-12 * (1.0 + d_normal.norm()));
    const FactorEvaluation adjacent =
        Evaluate(FactorOf(ShapeCategory::k0, 1.0), Joined({{1, 0}, {0, 2}}, segment));
    EXPECT_LT((adjacent.jacobians[2] - d_normal).norm(), 1e-12 * (1.0 + d_normal.norm()));
    EXPECT_LT((adjacent.jacobians[3] + d_normal).norm(), 1e-12 * (1.0 + d_normal.norm()));
  }
}

TEST(ShapeFactor, IsUnchangedWhenTheWorldMoves) {
  const Pose2 motion(10.0, -20.0, 2.5);
  for (const ShapeCategory category : kCategories) {
    const ShapeFactor factor = FactorOf(category, 0.1);
    ExpectSameCostAfterMove(factor, factor, motion,
                            {{1.5, 0.3}, {0.4, -0.2}, {0.3, -0.2}, {0.1, 0.2}});
  }
}

TEST(ShapeFactor, RefusesASegmentOfNoLength) {
  const ShapeFactor factor = FactorOf(ShapeCategory::k0, 0.1);
  const Blocks sound = {{0.0, 0.0}, {1.0, 0.0}}, point = {{1.0, 2.0}, {1.0, 2.0}},
               endless = {{1e200, 0.0}, {0.0, 0.0}};
  EXPECT_TRUE(Evaluate(factor, Joined(sound, sound)).ok);
  for (const Blocks& bad : {point, endless}) {
    EXPECT_FALSE(Evaluate(factor, Joined(bad, sound)).ok);
    EXPECT_FALSE(Evaluate(factor, Joined(sound, bad)).ok);
  }
}

TEST(ClassifyShape, FindsTheRightAngleWithinTheMargin) {
  const double margin = DegToRad(10.0);
  for (int degrees = -180; degrees < 180; degrees += 7) {
    const Eigen::Vector2d normal = Turned(DegToRad(degrees), {1, 0});
    for (const ShapeCategory expected : kCategories) {
      for (const double off_deg : {-10.01, -9.99, 0.0, 9.99, 10.01, 45.0}) {
        const Eigen::Vector2d adjacent = Turned(AngleOf(expected) + DegToRad(off_deg), normal);
        ShapeCategory category;
        const bool found = ClassifyShape(normal, adjacent, margin, &category);
        EXPECT_EQ(found, std::abs(off_deg) < 10.0) << degrees << " " << off_deg;
        if (found) {
          EXPECT_EQ(category, expected) << degrees << " " << off_deg;
        }
      }
    }
  }
}

TEST(ClassifyShape, RefusesDegenerateNormals) {
  ShapeCategory category;
  EXPECT_FALSE(ClassifyShape({0, 0}, {1, 0}, 0.1, &category));
  EXPECT_FALSE(ClassifyShape({1, 0}, {0, 0}, 0.1, &category));
  EXPECT_FALSE(ClassifyShape({kNaN, 0}, {1, 0}, 0.1, &category));
  EXPECT_FALSE(ClassifyShape({kInfinity, 0}, {1, 0}, 0.1, &category));
  EXPECT_EQ(SegmentNormal({1, 2}, {1, 2}), Eigen::Vector2d(0, 0));
}

}  // namespace
}  // namespace plumbline
