#ifndef PLUMBLINE_CORE_ANGLE_H_
#define PLUMBLINE_CORE_ANGLE_H_

#include <cmath>

namespace plumbline {

constexpr double kPi = 3.14159265358979323846;

constexpr double DegToRad(double degrees) { return degrees * (kPi / 180.0); }
constexpr double RadToDeg(double radians) { return radians * (180.0 / kPi); }

/// Returns `angle` [rad] moved by a multiple of 2 pi into [-pi, pi).
/// T is double or an automatic-differentiation scalar; the derivative is 1 everywhere but at the
/// cut itself.
template <typename T>
T NormalizeAngle(const T& angle) {
  using std::floor;
  T wrapped = angle - T(2.0 * kPi) * floor((angle + T(kPi)) / T(2.0 * kPi));
  // Rounding can choose the neighbouring turn for an angle at the cut.
  if (wrapped >= T(kPi)) return wrapped - T(2.0 * kPi);
  if (wrapped < T(-kPi)) return wrapped + T(2.0 * kPi);
  return wrapped;
}

/// The angle [rad] of the vector (x, y), like atan2. Up to 0.05 rad, where most angles between a
/// measurement and its estimate are, a polynomial that is exact to rounding takes its place.
inline double AngleOf(double x, double y) {
  const double tangent = y / x, squared = tangent * tangent;
  if (!(x > 0.0 && squared <= 0.05 * 0.05)) return std::atan2(y, x);
  return tangent *
         (1.0 -
          squared * (1.0 / 3 -
                     squared * (1.0 / 5 -
                                squared * (1.0 / 7 - squared * (1.0 / 9 - squared * (1.0 / 11))))));
}

}  // namespace plumbline

#endif  // PLUMBLINE_CORE_ANGLE_H_
