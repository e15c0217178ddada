// Stands in for rclcpp: what the plug-in uses of it, declared as it is there.
#ifndef PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_STAND_IN_RCLCPP_RCLCPP_HPP_
#define PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_STAND_IN_RCLCPP_RCLCPP_HPP_

#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <variant>

namespace rclcpp {

class Logger {
 public:
  explicit Logger(std::string name) : name_(std::move(name)) {}
  const char* get_name() const { return name_.c_str(); }

 private:
  std::string name_;
};
inline Logger get_logger(const std::string& name) { return Logger(name); }

class ParameterValue {
 public:
  explicit ParameterValue(bool value) : value_(value) {}
  explicit ParameterValue(int value) : value_(std::int64_t{value}) {}
  explicit ParameterValue(std::int64_t value) : value_(value) {}
  explicit ParameterValue(double value) : value_(value) {}
  explicit ParameterValue(const std::string& value) : value_(value) {}

  bool as_bool() const { return std::get<bool>(value_); }
  std::int64_t as_int() const { return std::get<std::int64_t>(value_); }
  double as_double() const { return std::get<double>(value_); }

 private:
  std::variant<bool, std::int64_t, double, std::string> value_;
};

class Node {
 public:
  using SharedPtr = std::shared_ptr<Node>;

  bool has_parameter(const std::string& name) const { return parameters_.count(name) > 0; }
  const ParameterValue& declare_parameter(const std::string& name, const ParameterValue& value) {
    return parameters_.emplace(name, value).first->second;
  }
  ParameterValue get_parameter(const std::string& name) const { return parameters_.at(name); }
  Logger get_logger() const { return Logger("slam_toolbox"); }

 private:
  std::map<std::string, ParameterValue> parameters_;
};

}  // namespace rclcpp

#define RCLCPP_WARN(logger, ...)                             \
  do {                                                       \
    std::fprintf(stderr, "[WARN] [%s]: ", logger.get_name()); \
    std::fprintf(stderr, __VA_ARGS__);                       \
    std::fputc('\n', stderr);                                \
  } while (0)

#endif  // PLUMBLINE_TEST_APPS_SLAM_TOOLBOX_STAND_IN_RCLCPP_RCLCPP_HPP_
