#ifndef PLUMBLINE_TEST_APPS_IO_GZIP_BYTES_H_
#define PLUMBLINE_TEST_APPS_IO_GZIP_BYTES_H_

#include <zlib.h>

#include <string>

namespace plumbline {

/// The bytes as gzip has them, compressed by the routine of zlib that knows the format.
inline std::string GzipBytes(std::string bytes) {
  std::string out(bytes.size() + bytes.size() / 100 + 100, '\0');
  z_stream stream{};
  deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_IO_GZIP_BYTES_H_
