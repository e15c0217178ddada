// A robot for tests of the live program, on Fast DDS and Fast CDR. Takes commands from standard
// input, a line each, and answers each with a line that begins with "done".
//   fast_dds_peer DOMAIN NAMESPACE
// "find" and "drive 0 1000 100" measure the time from a scan to its transform at 10 Hz.

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <chrono>
#include <cstdlib>
#include <deque>
#include <iomanip>
#include <iostream>
#include <limits>
#include <map>
#include <mutex>
#include <sstream>
#include <thread>

#include "plumbline/test/apps/live/fast_dds_peer.h"
#include "plumbline/test/apps/live/robot_messages.h"
#include "plumbline/test/apps/live/simulated_robot.h"

namespace plumbline {
namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastdds::dds::DataWriter;

constexpr char kTransformType[] = "tf2_msgs::msg::dds_::TFMessage_";
constexpr char kScanType[] = "sensor_msgs::msg::dds_::LaserScan_";
constexpr char kGridType[] = "nav_msgs::msg::dds_::OccupancyGrid_";

// Serialises a message with Fast CDR.
template <typename Write>
std::string Serialised(std::size_t max_bytes, const Write& write) {
  std::vector<char> buffer(max_bytes);
  eprosima::fastcdr::FastBuffer bytes(buffer.data(), buffer.size());
  Cdr cdr(bytes, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  write(&cdr);
  return std::string(buffer.data(), cdr.getSerializedDataLength());
}

void WriteHeader(double stamp_s, const std::string& frame, Cdr* cdr) {
  const auto seconds = static_cast<std::int32_t>(std::floor(stamp_s));
  *cdr << seconds << static_cast<std::uint32_t>(std::lround(1e9 * (stamp_s - seconds))) << frame;
}

std::string ScanMessage(const RosScan& scan) {
  return Serialised(200 + 4 * scan.ranges.size(), [&](Cdr* cdr) {
    WriteHeader(scan.stamp_s, scan.frame, cdr);
    for (const double value : {scan.angle_min_rad, scan.angle_max_rad, scan.angle_increment_rad,
                               scan.time_increment_s, 0.0, scan.range_min_m, scan.range_max_m}) {
      *cdr << static_cast<float>(value);
    }
    *cdr << std::vector<float>(scan.ranges.begin(), scan.ranges.end()) << std::vector<float>();
  });
}

std::string TransformMessage(const std::vector<RosTransform>& transforms) {
  return Serialised(100 + 400 * transforms.size(), [&](Cdr* cdr) {
    *cdr << static_cast<std::uint32_t>(transforms.size());
    for (const RosTransform& transform : transforms) {
      WriteHeader(transform.stamp_s, transform.frame, cdr);
      *cdr << transform.child_frame;
      for (const double value : transform.pose.position) *cdr << value;
      for (const double value : transform.pose.rotation.coeffs()) *cdr << value;
    }
  });
}

// Reads a message with Fast CDR.
class Reading {
 public:
  explicit Reading(std::string bytes)
      : bytes_(std::move(bytes)),
        buffer_(bytes_.data(), bytes_.size()),
        cdr_(buffer_, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR) {
    cdr_.read_encapsulation();
  }
  template <typename T>
  T Take() {
    T value{};
    cdr_ >> value;
    return value;
  }
  double Time() {
    const auto seconds = Take<std::int32_t>();
    return seconds + 1e-9 * Take<std::uint32_t>();
  }

 private:
  std::string bytes_;
  eprosima::fastcdr::FastBuffer buffer_;
  Cdr cdr_;
};

// A transform from the map, as it came.
struct MapTransform {
  double stamp_s = 0.0;
  std::string child;
  double x = 0.0, y = 0.0, qz = 0.0, qw = 0.0;
};

class Peer {
 public:
  Peer(int domain, std::string ros_namespace)
      : domain_(domain), namespace_(std::move(ros_namespace)), dds_(domain) {
    scans_ = dds_.Advertise("rt" + namespace_ + "/scan", kScanType, false);
    odometry_ = dds_.Advertise("rt" + namespace_ + "/odom", "nav_msgs::msg::dds_::Odometry_", true);
    transforms_ = dds_.Advertise("rt/tf", kTransformType, true);
    static_transforms_ = dds_.Advertise("rt/tf_static", kTransformType, true, true);
    dds_.Subscribe("rt/tf", kTransformType, false,
                   [this](const std::string& bytes) { TakeTransforms(bytes); });
    dds_.Subscribe("rt" + namespace_ + "/map", kGridType, true, [this](const std::string& bytes) {
      const std::lock_guard<std::mutex> lock(mutex_);
      map_ = bytes;
    });
    dds_.Subscribe("rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_", false,
                   [this](const std::string& bytes) { TakeDiagnostics(bytes); });
  }

  // False on an unknown command.
  bool Do(const std::string& line) {
    std::istringstream words(line);
    std::string command, a, b, c;
    words >> command >> a >> b >> c;
    if (command == "find") return Answer(FindProgram());
    if (command == "drive") {
      return Answer(Drive(std::atoi(a.c_str()), std::atoi(b.c_str()), std::atoi(c.c_str())));
    }
    if (command == "stream") return Answer(Stream(std::atoi(a.c_str()), std::atoi(b.c_str())));
    if (command == "bag") return Answer(PlayBag(a, b == "without_odometry"));
    if (command == "transforms") return Answer(Transforms());
    if (command == "map") return Answer(MapText(Locked(map_)));
    if (command == "late_map") return Answer(LateMap());
    if (command == "diagnostics") return Answer(Locked(diagnostics_));
    if (command == "bad") return Answer(SendBad(a));
    if (command == "call") return Answer(Call(a, b, c));
    return false;
  }

 private:
  static bool Answer(const std::string& text) {
    std::cout << "done " << text << std::endl;
    return true;
  }

  static void Write(DataWriter* writer, std::string bytes) { writer->write(&bytes); }

  template <typename Condition>
  static bool WaitUntil(double time_s, const Condition& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(time_s);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  }

  std::string Locked(const std::string& text) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return text;
  }

  static int NumReaders(DataWriter* writer) {
    eprosima::fastdds::dds::PublicationMatchedStatus status;
    writer->get_publication_matched_status(status);
    return status.current_count;
  }

  std::string FindProgram() {
    // The robot reads the transforms, too.
    const bool found = WaitUntil(20.0, [this] {
      return NumReaders(scans_) >= 1 && NumReaders(transforms_) >= 2 &&
             NumReaders(static_transforms_) >= 1;
    });
    if (!found) return "not found";
    // It knows all writers of this robot if it answers to the last one, and all readers if the last
    // one of them gets a message.
    Write(static_transforms_, TransformMessage({{0.0, "nothing", "of_use", RosPose()}}));
    const bool is_known =
        static_transforms_->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(20, 0)) ==
            eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK &&
        WaitUntil(20.0, [this] { return !Locked(diagnostics_).empty(); });
    return is_known ? "found" : "not found by the program";
  }

  void TakeTransforms(const std::string& bytes) {
    Reading reading(bytes);
    const auto count = reading.Take<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
      MapTransform transform;
      transform.stamp_s = reading.Time();
      const auto parent = reading.Take<std::string>();
      transform.child = reading.Take<std::string>();
      double values[7];
      for (double& value : values) value = reading.Take<double>();
      transform.x = values[0];
      transform.y = values[1];
      transform.qz = values[5];
      transform.qw = values[6];
      if (parent != "map") continue;
      const std::lock_guard<std::mutex> lock(mutex_);
      map_transforms_.push_back(transform);
      ++num_map_transforms_;
    }
  }

  void TakeDiagnostics(const std::string& bytes) {
    Reading reading(bytes);
    reading.Time();
    reading.Take<std::string>();
    if (reading.Take<std::uint32_t>() == 0) return;
    std::ostringstream text;
    text << "level=" << static_cast<int>(reading.Take<std::uint8_t>()) << ' '
         << reading.Take<std::string>() << ": " << reading.Take<std::string>();
    reading.Take<std::string>();
    const auto count = reading.Take<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto key = reading.Take<std::string>();
      text << "; " << key << " = " << reading.Take<std::string>();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    diagnostics_ = text.str();
  }

  std::size_t NumMapTransforms() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return num_map_transforms_;
  }

  // Sends scans with the odometry before them, each when the one before has been mapped, but not
  // before a period [ms] has passed.
  std::string Drive(int first, int last, int period_ms) {
    if (!robot_) robot_ = std::make_unique<SimulatedRobot>();
    Write(static_transforms_, TransformMessage(robot_->StaticTransforms()));
    std::vector<double> delays_ms;
    for (int i = first; i < std::min(last, robot_->num_scans()); ++i) {
      const std::size_t before = NumMapTransforms();
      Write(transforms_, TransformMessage(robot_->OdometryTransform(i)));
      const auto start = std::chrono::steady_clock::now();
      Write(scans_, ScanMessage(robot_->Scan(i)));
      if (!WaitUntil(30.0, [&] { return NumMapTransforms() > before; })) {
        return "no transform for scan " + std::to_string(i);
      }
      delays_ms.push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
              .count());
      std::this_thread::sleep_until(start + std::chrono::milliseconds(period_ms));
    }
    std::sort(delays_ms.begin(), delays_ms.end());
    std::ostringstream text;
    text << delays_ms.size() << " scans; median "
         << (delays_ms.empty() ? 0.0 : delays_ms[delays_ms.size() / 2]) << " ms, 99 % "
         << (delays_ms.empty() ? 0.0 : delays_ms[delays_ms.size() * 99 / 100]) << " ms, at most "
         << (delays_ms.empty() ? 0.0 : delays_ms.back()) << " ms";
    return text.str();
  }

  // Sends scans with the odometry before them, whether or not they are mapped.
  std::string Stream(int first, int last) {
    if (!robot_) robot_ = std::make_unique<SimulatedRobot>();
    Write(static_transforms_, TransformMessage(robot_->StaticTransforms()));
    for (int i = first; i < std::min(last, robot_->num_scans()); ++i) {
      Write(transforms_, TransformMessage(robot_->OdometryTransform(i)));
      Write(scans_, ScanMessage(robot_->Scan(i)));
      std::this_thread::sleep_for(std::chrono::milliseconds(40));
    }
    return "sent";
  }

  // At most five scans are under way.
  std::string PlayBag(const std::string& path, bool without_odometry) {
    constexpr std::size_t kMaxUnderWay = 5;
    std::vector<RecordedMessage> messages;
    const Status status = ReadMessagesOfRobot(path, &messages);
    if (!status.ok()) return status.message();
    std::size_t num_sent = 0;
    const std::size_t before = NumMapTransforms();
    for (const RecordedMessage& message : messages) {
      std::this_thread::sleep_for(std::chrono::microseconds(200));
      if (message.topic == "/tf_static") {
        Write(static_transforms_, message.bytes);
      } else if (message.topic == "/tf") {
        if (!without_odometry) Write(transforms_, message.bytes);
      } else if (message.topic == "/odom") {
        if (!without_odometry) Write(odometry_, message.bytes);
      } else {
        if (!WaitUntil(30.0,
                       [&] { return NumMapTransforms() + kMaxUnderWay > before + num_sent; })) {
          return "scan " + std::to_string(num_sent) + " got no transform";
        }
        Write(scans_, message.bytes);
        ++num_sent;
      }
    }
    WaitUntil(30.0, [&] { return NumMapTransforms() >= before + num_sent; });
    return std::to_string(num_sent) + " scans, " + std::to_string(NumMapTransforms() - before) +
           " transforms";
  }

  // The transforms that have come since the last call.
  std::string Transforms() {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::ostringstream text;
    text << std::setprecision(17) << map_transforms_.size();
    for (const MapTransform& transform : map_transforms_) {
      text << " | " << transform.stamp_s << ' ' << transform.child << ' ' << transform.x << ' '
           << transform.y << ' ' << transform.qz << ' ' << transform.qw;
    }
    map_transforms_.clear();
    return text.str();
  }

  static std::string MapText(const std::string& bytes) {
    if (bytes.empty()) return "no map";
    Reading reading(bytes);
    std::ostringstream text;
    text << std::setprecision(17) << reading.Time();
    text << ' ' << reading.Take<std::string>();
    reading.Time();
    text << ' ' << reading.Take<float>();
    text << ' ' << reading.Take<std::uint32_t>();
    text << ' ' << reading.Take<std::uint32_t>();
    text << ' ' << reading.Take<double>();
    text << ' ' << reading.Take<double>();
    for (int i = 0; i < 5; ++i) reading.Take<double>();
    std::string cells;
    for (const std::int8_t cell : reading.Take<std::vector<std::int8_t>>()) {
      cells += static_cast<char>(cell);
    }
    text << ' ' << cells.size() << ' ' << HashOf(cells);
    return text.str();
  }

  // The map as a participant gets it that comes now.
  std::string LateMap() {
    std::string map;
    FastDdsPeer late(domain_);
    late.Subscribe("rt" + namespace_ + "/map", kGridType, true, [&](const std::string& bytes) {
      const std::lock_guard<std::mutex> lock(mutex_);
      map = bytes;
    });
    WaitUntil(20.0, [&] { return !Locked(map).empty(); });
    return MapText(Locked(map));
  }

  std::string SendBad(const std::string& kind) {
    if (!robot_) robot_ = std::make_unique<SimulatedRobot>();
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    RosScan scan = robot_->Scan(0);
    if (kind == "nan") {
      scan.angle_min_rad = kNaN;
    } else if (kind == "huge") {
      scan.ranges.assign(120000, 1.0);
    } else if (kind == "frame") {
      scan.stamp_s += 1e4;
      scan.frame = "rear_laser";
    }
    std::string bytes = ScanMessage(scan);
    if (kind == "short") bytes.resize(bytes.size() / 2);
    if (kind == "noise") bytes = "\x7f\x01 no message at all";
    if (kind == "transform") {
      std::vector<RosTransform> transforms = robot_->OdometryTransform(0);
      transforms[0].pose.position.x() = kNaN;
      Write(transforms_, TransformMessage(transforms));
      return "sent";
    }
    if (kind == "flood") {
      for (int i = 0; i < 2000; ++i) {
        scan.stamp_s = robot_->StampS(robot_->num_scans() - 1) + 2.0 + 0.001 * i;
        Write(scans_, ScanMessage(scan));
        std::this_thread::sleep_for(std::chrono::microseconds(500));
      }
      return "sent";
    }
    Write(scans_, bytes);
    return "sent";
  }

  // Calls a service: type is "std_srvs::srv::dds_::Trigger"; a text, or else a flag.
  std::string Call(const std::string& service, const std::string& type, const std::string& text) {
    const std::string name = namespace_ + "/plumbline/" + service;
    constexpr std::uint64_t kClient = 4711;
    dds_.Subscribe("rr" + name + "Reply", type + "_Response_", false,
                   [this](const std::string& bytes) {
                     Reading reading(bytes);
                     if (reading.Take<std::uint64_t>() != kClient) return;
                     reading.Take<std::int64_t>();
                     const bool success = reading.Take<bool>();
                     const std::lock_guard<std::mutex> lock(mutex_);
                     reply_ = (success ? "success: " : "failure: ") + reading.Take<std::string>();
                   });
    DataWriter* requests = dds_.Advertise("rq" + name + "Request", type + "_Request_", true);
    WaitUntil(20.0, [&] { return NumReaders(requests) > 0; });
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    Write(requests, Serialised(1000, [&](Cdr* cdr) {
            *cdr << kClient << std::int64_t{1};
            if (type.find("AddDiagnostics") != std::string::npos) {
              *cdr << text;
            } else {
              *cdr << (text == "true");
            }
          }));
    WaitUntil(60.0, [this] { return !Locked(reply_).empty(); });
    return std::exchange(reply_, "");
  }

  const int domain_;
  const std::string namespace_;
  DataWriter *scans_ = nullptr, *odometry_ = nullptr, *transforms_ = nullptr,
             *static_transforms_ = nullptr;
  std::unique_ptr<SimulatedRobot> robot_;

  std::mutex mutex_;
  std::vector<MapTransform> map_transforms_;
  std::size_t num_map_transforms_ = 0;
  std::string map_, diagnostics_, reply_;
  FastDdsPeer dds_;  // last: its threads use the others
};

}  // namespace
}  // namespace plumbline

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  plumbline::Peer peer(std::atoi(argv[1]), argv[2]);
  for (std::string line; std::getline(std::cin, line);) {
    if (!peer.Do(line)) return 1;
  }
  return 0;
}
