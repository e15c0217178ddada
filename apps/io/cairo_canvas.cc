#include "plumbline/apps/io/cairo_canvas.h"

#include <ostream>

namespace plumbline {
namespace {

cairo_status_t WriteBytes(void* stream, const unsigned char* data, unsigned int size) {
  static_cast<std::ostream*>(stream)->write(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;  // AtomicFile::Commit reports a failure.
}

}  // namespace

Status CommitPng(const std::string& path, cairo_surface_t* surface, cairo_t* context,
                 AtomicFile* file) {
  cairo_status_t result = cairo_status(context);
  if (result == CAIRO_STATUS_SUCCESS) {
    result = cairo_surface_write_to_png_stream(surface, WriteBytes, &file->stream());
  }
  if (result != CAIRO_STATUS_SUCCESS) {
    return Status::Unavailable("cannot draw '" + path + "': " + cairo_status_to_string(result));
  }
  return file->Commit();
}

}  // namespace plumbline
