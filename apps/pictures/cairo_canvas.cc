#include "plumbline/apps/pictures/cairo_canvas.h"

#include "plumbline/apps/pictures/png_file.h"

namespace plumbline {

void SelectFont(double size_px, cairo_t* context) {
  cairo_select_font_face(context, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, size_px);
}

void DrawText(const std::string& text, double x, double y, TextAnchor anchor, cairo_t* context) {
  const double share = anchor == TextAnchor::kLeft     ? 0.0
                       : anchor == TextAnchor::kCenter ? 0.5
                                                       : 1.0;
  cairo_move_to(context, x - share * TextWidth(text, context), y);
  cairo_show_text(context, text.c_str());
  cairo_new_path(context);  // Text leaves its end behind as the current point.
}

double TextWidth(const std::string& text, cairo_t* context) {
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  return extents.x_advance;
}

Status CommitPng(const std::string& path, cairo_surface_t* surface, cairo_t* context,
                 AtomicFile* file) {
  const auto failure = [&](const std::string& reason) {
    return Status::Unavailable("cannot draw '" + path + "': " + reason);
  };
  const cairo_status_t result = cairo_status(context);
  if (result != CAIRO_STATUS_SUCCESS) return failure(cairo_status_to_string(result));
  std::string error;
  if (!WritePng(surface, &file->stream(), &error)) return failure(error);
  return file->Commit();
}

}  // namespace plumbline
