#include "plumbline/apps/bags/ros_message.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "plumbline/apps/io/byte_reader.h"
#include "plumbline/core/input_limits.h"

namespace plumbline {
namespace {

// Of CDR: the byte order, as the second byte of the header names it. Others are parameter lists and
// later versions of the encoding, which ROS 2 does not write.
constexpr std::uint8_t kBigEndian = 0, kLittleEndian = 1;
constexpr std::size_t kHeaderBytes = 4;
// CDR may be filled up to a multiple of its largest type.
constexpr std::size_t kMaxPaddingBytes = 7;

// The number that these bits are.
template <typename T, typename Bits>
double FloatOf(Bits bits) {
  static_assert(sizeof(T) == sizeof(Bits), "IEEE 754");
  T value = 0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

// Takes the fields of a message in their order. The first failure sticks.
class FieldDecoder {
 public:
  FieldDecoder(RosEncoding encoding, std::string_view bytes)
      : is_cdr_(encoding == RosEncoding::kCdr), reader_(bytes) {
    if (is_cdr_) TakeHeader();
    size_ = reader_.rest().size();
  }

  double Double(const char* field) { return Float<double, std::uint64_t>(field); }
  double Single(const char* field) { return Float<float, std::uint32_t>(field); }

  std::string Text(const char* field) {
    const std::string_view text = reader_.Bytes(Number<std::uint32_t>(field));
    if (!reader_.ok()) Fail(field, "its length is more than the message holds");
    if (!is_cdr_ || text.empty()) return std::string(text);
    if (text.back() != '\0') Fail(field, "its text does not end with a zero byte");
    return std::string(text.substr(0, text.size() - 1));
  }

  // Of a std_msgs/Header.
  void Header(double* stamp_s, std::string* frame) {
    if (!is_cdr_) Number<std::uint32_t>("header.seq");
    const auto seconds = Number<std::uint32_t>("header.stamp");
    const auto nanoseconds = Number<std::uint32_t>("header.stamp");
    // Unsigned in ROS 1, signed in ROS 2.
    *stamp_s = (is_cdr_ ? static_cast<double>(static_cast<std::int32_t>(seconds))
                        : static_cast<double>(seconds)) +
               1e-9 * static_cast<double>(nanoseconds);
    *frame = Text("header.frame_id");
  }

  RosPose Pose(const char* field) {
    RosPose pose;
    for (double& value : pose.position) value = Double(field);
    for (double& value : pose.rotation.coeffs()) value = Double(field);  // x, y, z, w
    return pose;
  }

  // Number of elements of a sequence, each of which takes some bytes at least: what is allocated
  // for them is bounded by the message.
  std::size_t Count(const char* field, std::size_t min_bytes) {
    const auto count = Number<std::uint32_t>(field);
    if (count <= reader_.rest().size() / min_bytes) return count;
    Fail(field, "its " + std::to_string(count) + " elements are more than the message holds");
    return 0;
  }

  std::vector<double> Singles(const char* field) {
    std::vector<double> values(Count(field, sizeof(float)));
    for (double& value : values) value = Single(field);
    return values;
  }

  std::uint32_t Unsigned(const char* field) { return Number<std::uint32_t>(field); }
  std::uint8_t Byte(const char* field) { return Number<std::uint8_t>(field); }

  // A sequence of bytes.
  std::string_view Bytes(const char* field) { return reader_.Bytes(Count(field, 1)); }

  void SkipSingles(const char* field) {
    reader_.Bytes(Count(field, sizeof(float)) * sizeof(float));
  }

  void SkipDoubles(const char* field, int count) {
    for (int i = 0; i < count; ++i) Double(field);
  }

  // Refuses the message if it does not hold.
  void Require(bool holds, const char* field, const std::string& problem) {
    if (!holds) Fail(field, problem);
  }

  bool ok() const { return fault_.empty(); }

  // Nothing may be left.
  bool Finish(std::string* fault) {
    const std::size_t left = reader_.rest().size();
    if (fault_.empty() && left > (is_cdr_ ? kMaxPaddingBytes : 0)) {
      fault_ = "it is " + std::to_string(left) + " bytes longer than its type has it";
    }
    if (!fault_.empty()) *fault = fault_;
    return fault_.empty();
  }

 private:
  void TakeHeader() {
    const std::string_view header = reader_.Bytes(kHeaderBytes);
    if (!reader_.ok()) return Fail("encapsulation", "the message ends before it");
    const auto order = static_cast<std::uint8_t>(header[1]);
    if (header[0] != 0 || order > kLittleEndian) {
      return Fail("encapsulation", "it is not that of plain CDR");
    }
    is_big_endian_ = order == kBigEndian;
  }

  void Fail(const char* field, const std::string& problem) {
    if (fault_.empty()) fault_ = std::string("field '") + field + "': " + problem;
    reader_ = ByteReader({});
  }

  // CDR: a number is aligned to its size, counted from behind the header.
  template <typename T>
  T Number(const char* field) {
    if (is_cdr_) {
      const std::size_t at = size_ - reader_.rest().size();
      reader_.Bytes((sizeof(T) - at % sizeof(T)) % sizeof(T));
    }
    const std::string_view bytes = reader_.Bytes(sizeof(T));
    if (!reader_.ok()) {
      Fail(field, "the message ends before it");
      return 0;
    }
    if (!is_big_endian_) return LoadLittleEndian<T>(bytes.data());
    std::array<char, sizeof(T)> reversed;
    std::reverse_copy(bytes.begin(), bytes.end(), reversed.begin());
    return LoadLittleEndian<T>(reversed.data());
  }

  template <typename T, typename Bits>
  double Float(const char* field) {
    return FloatOf<T>(Number<Bits>(field));
  }

  const bool is_cdr_;
  ByteReader reader_;
  bool is_big_endian_ = false;
  std::size_t size_ = 0;  // without the header
  std::string fault_;
};

// The fields that a LaserScan and a MultiEchoLaserScan begin with.
void DecodeScanStart(FieldDecoder* decoder, RosScan* scan) {
  decoder->Header(&scan->stamp_s, &scan->frame);
  scan->angle_min_rad = decoder->Single("angle_min");
  scan->angle_max_rad = decoder->Single("angle_max");
  scan->angle_increment_rad = decoder->Single("angle_increment");
  scan->time_increment_s = decoder->Single("time_increment");
  decoder->Single("scan_time");
  scan->range_min_m = decoder->Single("range_min");
  scan->range_max_m = decoder->Single("range_max");
}

// One list of numbers per beam.
std::vector<std::vector<double>> DecodeEchoes(FieldDecoder* decoder, const char* field) {
  constexpr std::size_t kMinEchoBytes = 4;
  std::vector<std::vector<double>> echoes(decoder->Count(field, kMinEchoBytes));
  for (std::vector<double>& echo : echoes) echo = decoder->Singles(field);
  return echoes;
}

// A coordinate of the points of a cloud.
struct CloudField {
  std::string_view bytes;  // of the points, from this field of the first one on
  bool is_double = false;
  bool is_big_endian = false;

  double At(std::size_t offset) const {
    const std::string_view number = bytes.substr(offset, is_double ? 8 : 4);
    std::array<char, 8> ordered = {};
    if (is_big_endian) {
      std::reverse_copy(number.begin(), number.end(), ordered.begin());
    } else {
      std::copy(number.begin(), number.end(), ordered.begin());
    }
    return is_double ? FloatOf<double>(LoadLittleEndian<std::uint64_t>(ordered.data()))
                     : FloatOf<float>(LoadLittleEndian<std::uint32_t>(ordered.data()));
  }
};

// Reads a PointCloud2 behind its header.
class CloudDecoder {
 public:
  explicit CloudDecoder(FieldDecoder* decoder) : decoder_(*decoder) {}

  std::vector<Eigen::Vector3d> Points() {
    const std::uint64_t height = decoder_.Unsigned("height"), width = decoder_.Unsigned("width");
    TakeFields();
    const bool is_big_endian = decoder_.Byte("is_bigendian") != 0;
    const std::uint64_t point_step = decoder_.Unsigned("point_step");
    const std::uint64_t row_step = decoder_.Unsigned("row_step");
    const std::string_view data = decoder_.Bytes("data");
    decoder_.Byte("is_dense");
    for (const std::uint64_t end : ends_) {
      decoder_.Require(end <= point_step, "point_step", "it is less than the fields take");
    }
    if (!decoder_.ok() || height == 0 || width == 0) return {};
    const std::uint64_t row = width * point_step;
    const bool fits =
        row <= data.size() &&
        (height == 1 || (row_step >= row && height - 1 <= (data.size() - row) / row_step));
    decoder_.Require(fits, "data", "it is shorter than height, width and the steps say");
    if (!decoder_.ok()) return {};
    for (std::size_t i = 0; i < 3; ++i) {
      coordinates_[i].bytes = data.substr(offsets_[i]);
      coordinates_[i].is_big_endian = is_big_endian;
    }
    std::vector<Eigen::Vector3d> points;
    points.reserve(height * width);
    for (std::uint64_t y = 0; y < height; ++y) {
      for (std::uint64_t x = 0; x < width; ++x) {
        const std::size_t at = y * row_step + x * point_step;
        points.emplace_back(coordinates_[0].At(at), coordinates_[1].At(at), coordinates_[2].At(at));
      }
    }
    return points;
  }

 private:
  // Of a sensor_msgs/PointField: x, y and z must be there.
  void TakeFields() {
    constexpr std::size_t kMinFieldBytes = 4 + 4 + 1 + 4;
    constexpr std::uint8_t kFloat = 7, kDouble = 8;
    const std::size_t num_fields = decoder_.Count("fields", kMinFieldBytes);
    for (std::size_t i = 0; i < num_fields; ++i) {
      const std::string name = decoder_.Text("fields.name");
      const std::uint64_t offset = decoder_.Unsigned("fields.offset");
      const std::uint8_t type = decoder_.Byte("fields.datatype");
      decoder_.Unsigned("fields.count");
      const std::size_t axis = name == "x" ? 0 : name == "y" ? 1 : name == "z" ? 2 : 3;
      if (axis == 3) continue;
      decoder_.Require(type == kFloat || type == kDouble, "fields",
                       "'" + name + "' is neither FLOAT32 nor FLOAT64");
      coordinates_[axis].is_double = type == kDouble;
      offsets_[axis] = offset;
      ends_[axis] = offset + (type == kDouble ? 8 : 4);
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      decoder_.Require(ends_[axis] > 0, "fields", "x, y and z are not all among them");
    }
  }

  FieldDecoder& decoder_;
  std::array<CloudField, 3> coordinates_;
  std::array<std::uint64_t, 3> offsets_ = {}, ends_ = {};  // within a point; end 0: no such field
};

}  // namespace

bool ToIsometry(const RosPose& pose, Eigen::Isometry3d* transform, std::string* fault) {
  if (!pose.position.allFinite() || !pose.rotation.coeffs().allFinite()) {
    *fault = "is not finite";
  } else if (pose.position.cwiseAbs().maxCoeff() > kMaxCoordinateM) {
    *fault = "is farther away than 10000 km";
  } else if (std::abs(pose.rotation.norm() - 1.0) > 0.01) {
    *fault = "has a quaternion that is no rotation";
  } else {
    *transform = Eigen::Translation3d(pose.position) * pose.rotation.normalized();
    return true;
  }
  return false;
}

bool DecodeScan(RosEncoding encoding, std::string_view bytes, RosScan* scan, std::string* fault) {
  FieldDecoder decoder(encoding, bytes);
  DecodeScanStart(&decoder, scan);
  scan->ranges = decoder.Singles("ranges");
  decoder.SkipSingles("intensities");
  return decoder.Finish(fault);
}

bool DecodeMultiEchoScan(RosEncoding encoding, std::string_view bytes, RosEcho echo, RosScan* scan,
                         std::string* fault) {
  FieldDecoder decoder(encoding, bytes);
  DecodeScanStart(&decoder, scan);
  const std::vector<std::vector<double>> ranges = DecodeEchoes(&decoder, "ranges");
  const std::vector<std::vector<double>> intensities = DecodeEchoes(&decoder, "intensities");
  scan->ranges.assign(ranges.size(), std::numeric_limits<double>::infinity());
  for (std::size_t beam = 0; beam < ranges.size(); ++beam) {
    if (ranges[beam].empty()) continue;
    std::size_t chosen = 0;
    if (echo == RosEcho::kStrongest) {
      const bool has_intensities =
          beam < intensities.size() && intensities[beam].size() == ranges[beam].size();
      decoder.Require(has_intensities, "intensities",
                      "it does not have one for each echo, so none is known to be the strongest");
      if (!has_intensities) break;
      const auto largest = std::max_element(intensities[beam].begin(), intensities[beam].end());
      chosen = static_cast<std::size_t>(largest - intensities[beam].begin());
    }
    scan->ranges[beam] = ranges[beam][chosen];
  }
  return decoder.Finish(fault);
}

bool DecodeCloud(RosEncoding encoding, std::string_view bytes, RosCloud* cloud,
                 std::string* fault) {
  FieldDecoder decoder(encoding, bytes);
  decoder.Header(&cloud->stamp_s, &cloud->frame);
  cloud->points = CloudDecoder(&decoder).Points();
  return decoder.Finish(fault);
}

bool DecodeOdometry(RosEncoding encoding, std::string_view bytes, RosOdometry* odometry,
                    std::string* fault) {
  FieldDecoder decoder(encoding, bytes);
  decoder.Header(&odometry->stamp_s, &odometry->frame);
  odometry->child_frame = decoder.Text("child_frame_id");
  odometry->pose = decoder.Pose("pose.pose");
  decoder.SkipDoubles("pose.covariance", 36);
  decoder.SkipDoubles("twist.twist", 6);
  decoder.SkipDoubles("twist.covariance", 36);
  return decoder.Finish(fault);
}

bool DecodeTransforms(RosEncoding encoding, std::string_view bytes,
                      std::vector<RosTransform>* transforms, std::string* fault) {
  // A stamp, two lengths and seven doubles.
  constexpr std::size_t kMinTransformBytes = 8 + 2 * 4 + 7 * 8;
  FieldDecoder decoder(encoding, bytes);
  transforms->resize(decoder.Count("transforms", kMinTransformBytes));
  for (RosTransform& transform : *transforms) {
    decoder.Header(&transform.stamp_s, &transform.frame);
    transform.child_frame = decoder.Text("child_frame_id");
    transform.pose = decoder.Pose("transforms.transform");
  }
  return decoder.Finish(fault);
}

}  // namespace plumbline
