#ifndef PLUMBLINE_APPS_PICTURES_PALETTE_H_
#define PLUMBLINE_APPS_PICTURES_PALETTE_H_

#include <array>
#include <cstddef>

namespace plumbline {

/// Red, green and blue in [0, 1].
struct Rgb {
  double red = 0.0, green = 0.0, blue = 0.0;
};

constexpr Rgb kBlack{0.00, 0.00, 0.00};
constexpr Rgb kBlue{0.00, 0.45, 0.70};
constexpr Rgb kVermilion{0.84, 0.37, 0.00};
constexpr Rgb kGreen{0.00, 0.62, 0.45};
constexpr Rgb kPurple{0.80, 0.47, 0.65};
constexpr Rgb kOrange{0.90, 0.62, 0.00};
constexpr Rgb kSkyBlue{0.34, 0.71, 0.91};
constexpr Rgb kGray{0.50, 0.50, 0.50};

enum class Marker { kDisc, kSquare, kDiamond, kTriangle, kTriangleDown };

/// Lengths of ink and gap in turn, in line widths. Nothing: a solid line.
struct DashPattern {
  std::array<double, 4> lengths{};
  int count = 0;
};

/// How one line of a chart is drawn.
struct SeriesStyle {
  Rgb color;
  Marker marker = Marker::kDisc;
  DashPattern dash;
};

/// The style of a chart's line `index`. Colours are told apart with any kind of colour vision
/// (Okabe and Ito: Color universal design, 2002; their yellow is too faint on white) and come again
/// after 8 lines; marker and dashes together tell 20 lines apart without any colour.
inline SeriesStyle StyleOfSeries(std::size_t index) {
  constexpr Rgb kColors[] = {kBlue, kVermilion, kGreen, kPurple, kOrange, kSkyBlue, kBlack, kGray};
  constexpr DashPattern kDashes[] = {
      {{}, 0}, {{6.0, 3.0}, 2}, {{1.5, 2.5}, 2}, {{6.0, 2.5, 1.5, 2.5}, 4}};
  constexpr int kNumMarkers = 5;
  return {kColors[index % 8], static_cast<Marker>(index % kNumMarkers), kDashes[index % 4]};
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_PALETTE_H_
