#ifndef PLUMBLINE_APPS_PICTURES_SCALE_BAR_H_
#define PLUMBLINE_APPS_PICTURES_SCALE_BAR_H_

typedef struct _cairo cairo_t;

namespace plumbline {

/// A bar that shows how long a stretch of the world is on a picture.
struct ScaleBar {
  double length_m = 0.0, length_px = 0.0;
  double font_px = 0.0;  ///< size of the current font, which its label is written in

  /// Room that bar and label take side by side [px].
  double WidthPx(cairo_t* context) const;
};

/// Draws bar and label in black; (x, y) is the left end of the bar.
void DrawScaleBar(const ScaleBar& bar, double x, double y, cairo_t* context);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_SCALE_BAR_H_
