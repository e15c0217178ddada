#include "plumbline/apps/bags/ros_message.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "plumbline/apps/io/byte_reader.h"

namespace plumbline {
namespace {

// Of CDR: the byte order, as the second byte of the header names it. Others are parameter lists and
// later versions of the encoding, which ROS 2 does not write.
constexpr std::uint8_t kBigEndian = 0, kLittleEndian = 1;
constexpr std::size_t kHeaderBytes = 4;
// CDR may be filled up to a multiple of its largest type.
constexpr std::size_t kMaxPaddingBytes = 7;

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

  void SkipSingles(const char* field) {
    reader_.Bytes(Count(field, sizeof(float)) * sizeof(float));
  }

  void SkipDoubles(const char* field, int count) {
    for (int i = 0; i < count; ++i) Double(field);
  }

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
    static_assert(sizeof(T) == sizeof(Bits), "IEEE 754");
    const Bits bits = Number<Bits>(field);
    T value = 0;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  const bool is_cdr_;
  ByteReader reader_;
  bool is_big_endian_ = false;
  std::size_t size_ = 0;  // without the header
  std::string fault_;
};

}  // namespace

bool DecodeScan(RosEncoding encoding, std::string_view bytes, RosScan* scan, std::string* fault) {
  FieldDecoder decoder(encoding, bytes);
  decoder.Header(&scan->stamp_s, &scan->frame);
  scan->angle_min_rad = decoder.Single("angle_min");
  decoder.Single("angle_max");
  scan->angle_increment_rad = decoder.Single("angle_increment");
  scan->time_increment_s = decoder.Single("time_increment");
  decoder.Single("scan_time");
  scan->range_min_m = decoder.Single("range_min");
  scan->range_max_m = decoder.Single("range_max");
  scan->ranges = decoder.Singles("ranges");
  decoder.SkipSingles("intensities");
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
