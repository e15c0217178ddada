#ifndef PLUMBLINE_APPS_PICTURES_PNG_FILE_H_
#define PLUMBLINE_APPS_PICTURES_PNG_FILE_H_

#include <cairo/cairo.h>

#include <iosfwd>
#include <string>

namespace plumbline {

/// Writes a drawing of CAIRO_FORMAT_RGB24, or of CAIRO_FORMAT_A8 as shades of gray, as PNG. Colors
/// are reduced to the 256 of a palette: the most frequent of similar ones stay as they are. Cairo's
/// own writer takes many times as long for a file more than twice as large. A failure of the stream
/// is left to its owner. False, with the reason in *error, if libpng cannot do it.
bool WritePng(cairo_surface_t* surface, std::ostream* stream, std::string* error);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PICTURES_PNG_FILE_H_
