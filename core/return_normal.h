#ifndef PLUMBLINE_CORE_RETURN_NORMAL_H_
#define PLUMBLINE_CORE_RETURN_NORMAL_H_

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "plumbline/core/angle.h"
#include "plumbline/core/pose_frame.h"

namespace plumbline {

/// The direction that the surface at a return faces, or that there is none: an angle in 16 bits, in
/// steps of 0.1 mrad. Normals are fitted to a few noisy returns, to some degrees at best.
class ReturnNormal {
 public:
  /// No surface.
  ReturnNormal() = default;
  /// The nearest step to a direction, of any length; none for the zero vector.
  explicit ReturnNormal(const Eigen::Vector2d& direction) {
    if (!(direction.squaredNorm() > 0.0)) return;
    // Single precision is a thousandth of a step.
    const float angle_rad =
        std::atan2(static_cast<float>(direction.y()), static_cast<float>(direction.x()));
    const double turns = static_cast<double>(angle_rad) / (2.0 * kPi);
    const auto step = static_cast<int>(std::lround((turns < 0.0 ? turns + 1.0 : turns) * kSteps));
    code_ = static_cast<std::uint16_t>(1 + step % kSteps);
  }

  /// Whether there is no surface.
  bool IsNone() const { return code_ == 0; }
  /// As a share of a full turn, counter-clockwise from the x axis, at least 0 and less than 1.
  /// Without meaning if there is no surface.
  double Turns() const { return (code_ - 1) * (1.0 / kSteps); }
  /// A unit vector; zero if there is no surface.
  Eigen::Vector2d Direction() const {
    if (IsNone()) return Eigen::Vector2d::Zero();
    // The nearest of some directions, which are at hand, and from there on by a small angle.
    const int near = (code_ - 1 + kStepsPerSector / 2) / kStepsPerSector;
    const std::array<double, 2>& at = kSectors[static_cast<std::size_t>(near % kNumSectors)];
    return Turned({at[0], at[1]}, (code_ - 1 - near * kStepsPerSector) * (2.0 * kPi / kSteps));
  }

  /// @{
  /// Exactly.
  bool operator==(const ReturnNormal& other) const { return code_ == other.code_; }
  bool operator!=(const ReturnNormal& other) const { return code_ != other.code_; }
  /// @}

 private:
  // Axes and diagonals are steps of their own.
  static constexpr int kNumSectors = 64, kStepsPerSector = 1023;
  static constexpr int kSteps = kNumSectors * kStepsPerSector;
  using Sectors = std::array<std::array<double, 2>, kNumSectors>;

  static constexpr Sectors MakeSectors() {
    constexpr std::size_t kQuarter = kNumSectors / 4;
    constexpr double kCos = 0.99518472667219688624, kSin = 0.09801714032956060199;  // of a sector
    Sectors sectors{};
    double c = 1.0, s = 0.0;
    for (std::size_t i = 0; i <= kQuarter / 2; ++i) {
      const double next_c = kCos * c - kSin * s, next_s = kSin * c + kCos * s;
      for (std::size_t quarter = 0; quarter < 4; ++quarter) {
        SetQuarter(c, s, quarter, &sectors[quarter * kQuarter + i]);
        // Mirrored at the diagonal; axes are exact.
        if (i > 0) SetQuarter(s, c, quarter, &sectors[(quarter + 1) * kQuarter - i]);
      }
      c = next_c;
      s = next_s;
    }
    return sectors;
  }
  static constexpr void SetQuarter(double c, double s, std::size_t quarter,
                                   std::array<double, 2>* at) {
    (*at)[0] = quarter == 0 ? c : quarter == 1 ? -s : quarter == 2 ? -c : s;
    (*at)[1] = quarter == 0 ? s : quarter == 1 ? c : quarter == 2 ? -s : -c;
  }
  static const Sectors kSectors;

  std::uint16_t code_ = 0;  // 0: none; else the step, plus one
};

inline constexpr ReturnNormal::Sectors ReturnNormal::kSectors = ReturnNormal::MakeSectors();

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_RETURN_NORMAL_H_
