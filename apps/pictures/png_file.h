#ifndef PLUMBLINE_APPS_PICTURES_PNG_FILE_H_
#define PLUMBLINE_APPS_PICTURES_PNG_FILE_H_

#include <cairo.h>

#include <iosfwd>
#include <string>

namespace plumbline {

/// Writes an image of CAIRO_FORMAT_RGB24, or of CAIRO_FORMAT_A8 as shades of gray, as PNG. Cairo's
/// own writer takes four times as long for a file a third larger: it filters every row, which
/// photographs need, not drawings. A failure of the stream is left to its owner. False, with the
/// reason in *error, if libpng cannot do it.
bool WritePng(cairo_surface_t* surface, std::ostream* stream, std::string* error);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_PNG_FILE_H_
