#include "plumbline/apps/io/ply_reader.h"

#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <string_view>
#include <utility>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/file_status.h"
#include "plumbline/apps/io/little_endian.h"
#include "plumbline/core/input_limits.h"

namespace plumbline {
namespace {

constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

// Size of a scalar type [bytes], 0 for an unknown one.
std::size_t SizeOf(std::string_view type) {
  static const std::map<std::string_view, std::size_t> kSizes = {
      {"char", 1},  {"uchar", 1},  {"short", 2},   {"ushort", 2}, {"int", 4},   {"uint", 4},
      {"float", 4}, {"double", 8}, {"int8", 1},    {"uint8", 1},  {"int16", 2}, {"uint16", 2},
      {"int32", 4}, {"uint32", 4}, {"float32", 4}, {"float64", 8}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

// Takes the header in line by line and knows then where x and y lie in a vertex.
class Header {
 public:
  void Take(FieldReader* fields) {
    const std::string_view keyword = fields->Word("keyword");
    if (!fields->ok() || keyword == "comment" || keyword == "obj_info") return;
    if (keyword == "format") {
      little_endian_ = fields->Word("format") == "binary_little_endian";
      if (!little_endian_) fields->Fail("format", "it is not binary_little_endian");
    } else if (keyword == "element") {
      TakeElement(fields);
    } else if (keyword == "property") {
      TakeProperty(fields);
    } else if (keyword == "end_header") {
      complete_ = true;
      if (!little_endian_) fields->Fail("format", "is missing");
      if (x_ == kNowhere || y_ == kNowhere) fields->Fail("property", "no x and y of type double");
    } else {
      fields->Fail("keyword", "it is none of a PLY header");
    }
  }

  bool complete() const { return complete_; }
  int num_vertices() const { return num_vertices_; }
  std::size_t vertex_size() const { return vertex_size_; }
  std::size_t x() const { return x_; }
  std::size_t y() const { return y_; }

 private:
  void TakeElement(FieldReader* fields) {
    ++num_elements_;
    if (num_elements_ > 1) return;
    if (fields->Word("element") != "vertex") fields->Fail("element", "the first one is no vertex");
    num_vertices_ = fields->Count("count");
  }

  void TakeProperty(FieldReader* fields) {
    if (num_elements_ != 1) return;
    const std::string_view type = fields->Word("type");
    const std::string_view name = fields->Word("name");
    const std::size_t size = SizeOf(type);
    if (size == 0) fields->Fail("type", Quote(type) + " is not a scalar type");
    const bool is_double = type == "double" || type == "float64";
    if (is_double && name == "x") x_ = vertex_size_;
    if (is_double && name == "y") y_ = vertex_size_;
    vertex_size_ += size;
  }

  bool complete_ = false;
  bool little_endian_ = false;
  int num_elements_ = 0;
  int num_vertices_ = 0;
  std::size_t vertex_size_ = 0;
  std::size_t x_ = kNowhere, y_ = kNowhere;
};

// A line without its end. False at the end of the file and where a line is longer than any of a
// header, as in a file of some other kind.
bool NextLine(std::istream* file, std::string* line) {
  char text[4096];
  const bool read = static_cast<bool>(file->getline(text, sizeof(text)));
  *line = text;
  return read;
}

Status ReadHeader(const std::string& path, std::istream* file, Header* header) {
  std::string line;
  if (!NextLine(file, &line) || line != "ply") {
    return Status::InvalidArgument(path + ":1: not a PLY file");
  }
  for (int line_number = 2; !header->complete(); ++line_number) {
    if (!NextLine(file, &line)) return Status::DataLoss(path + ": the header has no end");
    FieldReader fields(line);
    header->Take(&fields);
    if (!fields.ok()) {
      return Status::InvalidArgument(path + ":" + std::to_string(line_number) + ": " +
                                     fields.error());
    }
  }
  return Status::Ok();
}

}  // namespace

Status ReadPointsPly(const std::string& path, std::vector<double>* points) {
  PLUMBLINE_RETURN_IF_ERROR(RefusePipe(path));
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return ReadError("open", path, errno);
  Header header;
  PLUMBLINE_RETURN_IF_ERROR(ReadHeader(path, &file, &header));
  std::vector<double> result;
  std::vector<char> vertex(header.vertex_size());
  for (int v = 0; v < header.num_vertices(); ++v) {
    if (!file.read(vertex.data(), static_cast<std::streamsize>(vertex.size()))) {
      return Status::DataLoss(path + ": the file ends at vertex " + std::to_string(v) + " of " +
                              std::to_string(header.num_vertices()));
    }
    const double x = LoadDouble(&vertex[header.x()]), y = LoadDouble(&vertex[header.y()]);
    if (!IsWithinLimits({x, y, 0.0})) {
      return Status::InvalidArgument(path + ": vertex " + std::to_string(v) +
                                     " is not finite, or beyond 1e7 m");
    }
    result.insert(result.end(), {x, y});
  }
  *points = std::move(result);
  return Status::Ok();
}

}  // namespace plumbline
