#ifndef PLUMBLINE_APPS_PICTURES_CAIRO_CANVAS_H_
#define PLUMBLINE_APPS_PICTURES_CAIRO_CANVAS_H_

#include <cairo.h>

#include <memory>
#include <string>

#include "plumbline/apps/io/atomic_file.h"
#include "plumbline/core/status.h"

namespace plumbline {

struct CairoDeleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};
using CairoSurface = std::unique_ptr<cairo_surface_t, CairoDeleter>;
using CairoContext = std::unique_ptr<cairo_t, CairoDeleter>;

/// Sides of an image that Cairo can hold [px].
constexpr int kMaxImageSidePx = 32767;

/// Sets the font of all texts to come.
void SelectFont(double size_px, cairo_t* context);

enum class TextAnchor { kLeft, kCenter, kRight };

/// Draws in the current font and colour. (x, y) is the left, middle or right end of the base line.
void DrawText(const std::string& text, double x, double y, TextAnchor anchor, cairo_t* context);

/// Width of a text in the current font.
double TextWidth(const std::string& text, cairo_t* context);

/// Writes what `context` has drawn on `surface` to the open file, as PNG, and commits it. path: for
/// the message. Unavailable if the drawing or the writing failed.
Status CommitPng(const std::string& path, cairo_surface_t* surface, cairo_t* context,
                 AtomicFile* file);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_CAIRO_CANVAS_H_
