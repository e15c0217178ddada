#include "plumbline/solvers/terms/align_to_factors.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose2.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/sort_unique.h"
#include "plumbline/solvers/terms/custom_factor_terms.h"

namespace plumbline {
namespace {

// The poses and points that factors see, as a state of their own that moves as a whole.
class RigidFactors {
 public:
  RigidFactors(const SlamGraph& graph, const MapState& state) {
    std::vector<CustomFactor> factors = graph.factors();
    if (const std::optional<CustomFactor> gauge = GaugeFactor(graph)) factors.push_back(*gauge);
    std::vector<int> poses;
    std::vector<std::size_t> points;
    for (const CustomFactor& factor : factors) {
      poses.insert(poses.end(), factor.poses.begin(), factor.poses.end());
      points.insert(points.end(), factor.points.begin(), factor.points.end());
    }
    SortUnique(&poses);
    SortUnique(&points);
    const auto renumber = [](const auto& all, auto* ids) {
      for (auto& id : *ids) id = std::lower_bound(all.begin(), all.end(), id) - all.begin();
    };
    for (CustomFactor& factor : factors) {
      renumber(poses, &factor.poses);
      renumber(points, &factor.points);
    }
    terms_ = MakeFactorTerms(factors);
    for (const int pose : poses) poses_.push_back(state.WorldFromRobot(pose));
    if (!points.empty()) {
      const std::vector<double> all =
          state.points.empty() ? graph.MeasuredMap(state.poses) : state.points;
      for (const std::size_t point : points) {
        points_.emplace_back(all[2 * point], all[2 * point + 1]);
      }
    }
    for (const Pose2& pose : poses_) middle_ += pose.translation();
    for (const Eigen::Vector2d& point : points_) middle_ += point;
    middle_ /= static_cast<double>(poses_.size() + points_.size());
  }

  // The motion that turns all by a heading about their middle.
  Pose2 Turn(double yaw) const {
    const Pose2 turn(0.0, 0.0, yaw);
    const Eigen::Vector2d shift = middle_ - turn * middle_;
    return {shift.x(), shift.y(), yaw};
  }

  // By Levenberg and Marquardt. Infinite where the factors are undefined.
  double Minimize(Pose2* motion) const {
    constexpr int kMaxSteps = 50;
    constexpr double kSettled = 1e-12;  // of the cost
    double damping = 1e-6;
    double cost = Cost(*motion);
    for (int i = 0; i < kMaxSteps && damping < 1e6; ++i) {
      const Pose2 stepped = Step(*motion, damping);
      const double new_cost = Cost(stepped);
      if (!(new_cost < cost)) {
        damping *= 10.0;
        continue;
      }
      const bool settled = cost - new_cost <= kSettled * cost;
      *motion = stepped;
      cost = new_cost;
      damping *= 0.1;
      if (settled) break;
    }
    return cost;
  }

  double Cost(const Pose2& motion) const {
    const MapState moved = Moved(motion);
    double cost = 0.0;
    for (const auto& term : terms_) {
      if (!term->Linearize(Term::kNoScan, {moved.poses.data(), moved.points.data()}, {}, &cost)) {
        return std::numeric_limits<double>::infinity();
      }
    }
    return cost;
  }

 private:
  MapState Moved(const Pose2& motion) const {
    MapState moved;
    for (const Pose2& pose : poses_) {
      const Pose2 there = motion * pose;
      moved.poses.insert(moved.poses.end(), {there.x, there.y, there.yaw});
    }
    for (const Eigen::Vector2d& point : points_) {
      const Eigen::Vector2d there = motion * point;
      moved.points.insert(moved.points.end(), {there.x(), there.y()});
    }
    return moved;
  }

  // All moves by a motion about the middle: x, y [m], yaw [rad].
  static MapState Direction(const MapState& at, const Eigen::Vector2d& middle,
                            const Eigen::Vector3d& motion) {
    MapState direction;
    const auto add = [&](double x, double y, std::vector<double>* values) {
      const Eigen::Vector2d by =
          motion.head<2>() + motion[2] * TurnedLeft(Eigen::Vector2d(x, y) - middle);
      values->insert(values->end(), {by.x(), by.y()});
    };
    for (std::size_t i = 0; i < at.poses.size(); i += 3) {
      add(at.poses[i], at.poses[i + 1], &direction.poses);
      direction.poses.push_back(motion[2]);
    }
    for (std::size_t i = 0; i < at.points.size(); i += 2) {
      add(at.points[i], at.points[i + 1], &direction.points);
    }
    return direction;
  }

  Pose2 Step(const Pose2& motion, double damping) const {
    const MapState at = Moved(motion);
    const StateView view{at.poses.data(), at.points.data()};
    std::vector<double> by_pose(at.poses.size()), by_point(at.points.size());
    TermDerivatives out;
    out.pose_gradient = by_pose.data();
    out.point_gradient = by_point.data();
    double cost = 0.0;
    for (const auto& term : terms_) term->Linearize(Term::kNoScan, view, out, &cost);

    const Eigen::Vector2d middle = motion * middle_;
    const auto curvature = [&](const Eigen::Vector3d& by) {
      const MapState direction = Direction(at, middle, by);
      double sum = 0.0;
      for (const auto& term : terms_) {
        term->AddCurvature(Term::kNoScan, view, {direction.poses.data(), direction.points.data()},
                           &sum);
      }
      return sum;
    };
    const Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
    Eigen::Vector3d gradient;
    Eigen::Matrix3d information;
    for (int i = 0; i < 3; ++i) {
      const MapState direction = Direction(at, middle, axes.col(i));
      gradient[i] = Dot(by_pose, direction.poses) + Dot(by_point, direction.points);
      information(i, i) = curvature(axes.col(i));
      for (int j = 0; j < i; ++j) {
        const double of_both = curvature(axes.col(i) + axes.col(j));
        information(i, j) = information(j, i) =
            0.5 * (of_both - information(i, i) - information(j, j));
      }
    }
    const double least = 1e-12 * information.diagonal().maxCoeff();
    information.diagonal() += damping * information.diagonal().cwiseMax(least);
    const Eigen::Vector3d step = information.ldlt().solve(-gradient);
    const Pose2 turn(0.0, 0.0, step[2]);
    const Eigen::Vector2d shift = middle - turn * middle + step.head<2>();
    return Pose2(shift.x(), shift.y(), step[2]) * motion;
  }

  static double Dot(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
    return sum;
  }

  TermList terms_;
  std::vector<Pose2> poses_;
  std::vector<Eigen::Vector2d> points_;
  Eigen::Vector2d middle_ = Eigen::Vector2d::Zero();
};

}  // namespace

void AlignToFactors(const SlamGraph& graph, MapState* state, double least_gain) {
  if (!graph.fixed_poses().empty() || graph.factors().empty()) return;
  const RigidFactors factors(graph, *state);
  constexpr int kNumHeadings = 12;
  constexpr double kClearly = 0.999;  // of the cost: headings that the factors leave open are alike
  const double given_cost = factors.Cost(Pose2());
  double least = given_cost;
  Pose2 best;
  for (int i = 0; i < kNumHeadings; ++i) {
    Pose2 motion = factors.Turn(2.0 * kPi * i / kNumHeadings);
    const double cost = factors.Minimize(&motion);
    if (!(cost < (i == 0 ? least : kClearly * least))) continue;
    least = cost;
    best = motion;
  }
  if (!(least < given_cost - least_gain)) return;
  for (int pose = 0; pose < state->num_poses(); ++pose) {
    state->SetPose(pose, best * state->WorldFromRobot(pose));
  }
  for (std::size_t i = 0; i < state->points.size(); i += 2) {
    const Eigen::Vector2d moved = best * Eigen::Vector2d(state->points[i], state->points[i + 1]);
    state->points[i] = moved.x();
    state->points[i + 1] = moved.y();
  }
}

}  // namespace plumbline
