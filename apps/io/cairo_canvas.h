#ifndef PLUMBLINE_APPS_IO_CAIRO_CANVAS_H_
#define PLUMBLINE_APPS_IO_CAIRO_CANVAS_H_

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

/// Writes what `context` has drawn on `surface` to the open file, as PNG, and commits it. path: for
/// the message. Unavailable if the drawing or the writing failed.
Status CommitPng(const std::string& path, cairo_surface_t* surface, cairo_t* context,
                 AtomicFile* file);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_CAIRO_CANVAS_H_
