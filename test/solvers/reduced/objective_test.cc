// What the reduced solver minimises is the published energy with points and lines eliminated, under
// the changes that solvers/reduced/README.md lists.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <vector>

#include "plumbline/core/pose_frame.h"
#include "plumbline/solvers/landmarks/fit_landmark_lines.h"
#include "plumbline/solvers/landmarks/line_landmarks.h"
#include "plumbline/solvers/landmarks/line_observations.h"
#include "plumbline/test/solvers/noisy_room.h"

namespace plumbline {
namespace {

// A room that is mapped a little wrong, its landmarks, and a Gaussian manifold potential.
struct MappedRoom {
  NoisyRoom room = MakeNoisyRoom();
  FactorOptions factors;
  ThreadPool pool{1};
  MeasuredSurface surface;
  LineLandmarks cut;
  std::vector<PoseFrame> frames;
  LineObservations observations;

  MappedRoom() {
    factors.manifold.robust_gate_sigmas = std::numeric_limits<double>::infinity();
    DisturbPoses(0.01, room.graph, &room.state);
    surface = SurfaceOf(room.graph);
    cut = CutIntoLandmarks(room.graph, room.state.poses, surface,
                           LandmarkOptionsFor(factors, AssociationOptions()), &pool);
    frames = FramesOf(room.state.poses);
  }

  // Gives the energy of the returns on landmarks, points eliminated, at the lines at hand.
  double Weigh() {
    ReturnCompressor compressor(room.graph, NoiseOf(factors), &pool);
    observations = compressor.LayOut(cut.landmarks.size(), cut.landmark_of_return);
    return compressor.Weigh(cut.landmarks, frames,
                            GemanMcClure::FromGate(factors.manifold.robust_gate_sigmas),
                            &observations);
  }

  // Beam and manifold term of one return at its best point: with the beam's error as a Gaussian in
  // the plane about its measured end, a quadratic function of the point.
  double CostAtBestPoint(std::size_t r, const Eigen::Vector2d& normal, double offset_m) const {
    const int scan = room.graph.ScanOfReturn(r);
    const PoseFrame& frame = frames[room.graph.scan(scan).pose];
    const Eigen::Vector2d in_robot = room.graph.PointInRobot(r);
    const Eigen::Vector2d laser = room.graph.LaserOfScan(scan).robot_from_laser.translation();
    const Eigen::Vector2d beam = frame.Rotate(in_robot - laser);
    const Eigen::Vector2d end = frame.Rotate(in_robot) + frame.translation();
    const Eigen::Vector2d along = beam.normalized();
    const Eigen::Vector2d across = TurnedLeft(along);
    const double range_information = std::pow(factors.beam.sigma_range_m, -2);
    const double bearing_information = std::pow(factors.beam.sigma_bearing_rad * beam.norm(), -2);
    const Eigen::Matrix2d of_beam = range_information * along * along.transpose() +
                                    bearing_information * across * across.transpose();
    const double of_surface = std::pow(factors.manifold.sigma_m, -2);
    const Eigen::Matrix2d hessian = of_beam + of_surface * normal * normal.transpose();
    const double distance = normal.dot(end) - offset_m;
    const Eigen::Vector2d step = -hessian.inverse() * (of_surface * distance * normal);
    const double distance_after = distance + normal.dot(step);
    return 0.5 * step.dot(of_beam * step) + 0.5 * of_surface * distance_after * distance_after;
  }

  double CostAtBestPoints() const {
    double cost = 0.0;
    for (std::size_t r = 0; r < cut.landmark_of_return.size(); ++r) {
      if (cut.landmark_of_return[r] == LineLandmarks::kNone) continue;
      const LineLandmark& line = cut.landmarks[cut.landmark_of_return[r]];
      cost += CostAtBestPoint(r, line.normal, line.offset_m + line.normal.dot(line.origin));
    }
    return cost;
  }
};

TEST(ReducedObjectiveTest, IsThePublishedEnergyWithPointsEliminated) {
  MappedRoom room;
  const double expected = room.CostAtBestPoints();
  EXPECT_GT(expected, 100.0);
  EXPECT_NEAR(room.Weigh(), expected, 1e-9 * expected);
  // And the moments of the observations lose no more of it than their single precision.
  EXPECT_NEAR(LandmarkLineCost(room.observations, room.frames, room.cut.landmarks, &room.pool),
              expected, 2e-6 * expected);
}

TEST(ReducedObjectiveTest, TheLinesAreEliminatedToo) {
  MappedRoom room;
  room.Weigh();
  std::vector<LineLandmark> lines = room.cut.landmarks;
  const double cost = FitLandmarkLines(room.observations, room.frames, &room.pool, &lines);
  EXPECT_LE(cost, room.CostAtBestPoints() * (1.0 + 1e-9));
  EXPECT_NEAR(LandmarkLineCost(room.observations, room.frames, lines, &room.pool), cost,
              1e-9 * cost);
  // No other lines are cheaper, whichever way they are moved.
  for (const double step : {-1e-4, 1e-4}) {
    for (std::size_t p = 0; p < lines.size(); ++p) {
      std::vector<LineLandmark> shifted = lines, turned = lines;
      shifted[p].offset_m += step;
      turned[p].normal =
          Eigen::Vector2d(lines[p].normal + step * TurnedLeft(lines[p].normal)).normalized();
      EXPECT_GE(LandmarkLineCost(room.observations, room.frames, shifted, &room.pool), cost);
      EXPECT_GE(LandmarkLineCost(room.observations, room.frames, turned, &room.pool), cost);
    }
  }
}

}  // namespace
}  // namespace plumbline
