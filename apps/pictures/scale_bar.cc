#include "plumbline/apps/pictures/scale_bar.h"

#include <cairo.h>

#include <cstdio>
#include <string>

#include "plumbline/apps/pictures/cairo_canvas.h"

namespace plumbline {
namespace {

std::string LabelOf(const ScaleBar& bar) {
  char label[32];
  std::snprintf(label, sizeof(label), "%g m", bar.length_m);
  return label;
}

double GapPx(const ScaleBar& bar) { return 0.65 * bar.font_px; }

}  // namespace

double ScaleBar::WidthPx(cairo_t* context) const {
  return length_px + GapPx(*this) + TextWidth(LabelOf(*this), context);
}

void DrawScaleBar(const ScaleBar& bar, double x, double y, cairo_t* context) {
  const double tick_px = 0.28 * bar.font_px;
  cairo_set_source_rgb(context, 0.0, 0.0, 0.0);
  cairo_set_line_width(context, 0.11 * bar.font_px);
  cairo_move_to(context, x, y - tick_px);
  cairo_line_to(context, x, y + tick_px);
  cairo_move_to(context, x, y);
  cairo_line_to(context, x + bar.length_px, y);
  cairo_move_to(context, x + bar.length_px, y - tick_px);
  cairo_line_to(context, x + bar.length_px, y + tick_px);
  cairo_stroke(context);
  DrawText(LabelOf(bar), x + bar.length_px + GapPx(bar), y + 0.35 * bar.font_px, TextAnchor::kLeft,
           context);
}

}  // namespace plumbline
