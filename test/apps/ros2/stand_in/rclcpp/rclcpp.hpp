// Stands in for rclcpp: what the node uses of it, declared as in Humble and Jazzy.
#ifndef PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_RCLCPP_HPP_
#define PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_RCLCPP_HPP_

#include <bus.hpp>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <messages.hpp>
#include <mutex>
#include <rclcpp/qos.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

struct rmw_request_id_t {
  std::int64_t sequence_number = 0;
};

namespace rclcpp {

class Logger {
 public:
  explicit Logger(std::string name) : name_(std::move(name)) {}
  const char* get_name() const { return name_.c_str(); }

 private:
  std::string name_;
};

class Time {
 public:
  explicit Time(std::int32_t seconds) : seconds_(seconds) {}
  operator builtin_interfaces::msg::Time() const { return {seconds_, 0}; }

 private:
  std::int32_t seconds_;
};

using ParameterVariant = std::variant<bool, std::int64_t, double, std::string>;

class Parameter {
 public:
  Parameter(const std::string& name, bool value) : name_(name), value_(value) {}
  Parameter(const std::string& name, int value) : name_(name), value_(std::int64_t{value}) {}
  Parameter(const std::string& name, double value) : name_(name), value_(value) {}
  Parameter(const std::string& name, const std::string& value) : name_(name), value_(value) {}
  Parameter(const std::string& name, const char* value) : Parameter(name, std::string(value)) {}

  const std::string& get_name() const { return name_; }
  bool as_bool() const { return std::get<bool>(value_); }
  double as_double() const { return std::get<double>(value_); }
  std::string as_string() const { return std::get<std::string>(value_); }
  const ParameterVariant& variant() const { return value_; }

 private:
  std::string name_;
  ParameterVariant value_;
};

class NodeOptions {
 public:
  const std::vector<Parameter>& parameter_overrides() const { return overrides_; }
  NodeOptions& parameter_overrides(const std::vector<Parameter>& parameter_overrides) {
    overrides_ = parameter_overrides;
    return *this;
  }

 private:
  std::vector<Parameter> overrides_;
};

class SubscriptionBase : public stand_in::Receiver {
 public:
  using SharedPtr = std::shared_ptr<SubscriptionBase>;
  explicit SubscriptionBase(stand_in::Receiver receiver) : Receiver(std::move(receiver)) {}
};

class ServiceBase {
 public:
  using SharedPtr = std::shared_ptr<ServiceBase>;
  virtual ~ServiceBase() = default;
};

// What the test sends to a service: the request, and who takes the response.
template <typename ServiceT>
struct Call {
  std::shared_ptr<typename ServiceT::Request> request;
  std::function<void(const typename ServiceT::Response&)> respond;
};

template <typename ServiceT>
class Service : public ServiceBase, public std::enable_shared_from_this<Service<ServiceT>> {
 public:
  using Callback =
      std::function<void(std::shared_ptr<Service<ServiceT>>, std::shared_ptr<rmw_request_id_t>,
                         std::shared_ptr<typename ServiceT::Request>)>;

  Service(const std::string& name, Callback callback) {
    receiver_ = std::make_shared<stand_in::Receiver>(
        stand_in::Receiver{name, typeid(Call<ServiceT>), QoS(10),
                           [this, callback = std::move(callback)](const void* sent) {
                             const auto& call = *static_cast<const Call<ServiceT>*>(sent);
                             auto id = std::make_shared<rmw_request_id_t>();
                             {
                               const std::lock_guard<std::mutex> lock(mutex_);
                               id->sequence_number = static_cast<std::int64_t>(calls_.size());
                               calls_.push_back(call);
                             }
                             callback(this->shared_from_this(), id, call.request);
                           }});
    stand_in::Bus::Instance().Add(receiver_);
  }
  void send_response(rmw_request_id_t& req_id, typename ServiceT::Response& response) {
    const std::lock_guard<std::mutex> lock(mutex_);
    calls_.at(static_cast<std::size_t>(req_id.sequence_number)).respond(response);
  }

 private:
  std::mutex mutex_;
  std::shared_ptr<stand_in::Receiver> receiver_;
  std::vector<Call<ServiceT>> calls_;
};

class TimerBase {
 public:
  using SharedPtr = std::shared_ptr<TimerBase>;
  explicit TimerBase(std::function<void()> callback)
      : callback_(std::make_shared<std::function<void()>>(std::move(callback))) {
    stand_in::Bus::Instance().AddTimer(callback_);
  }

 private:
  std::shared_ptr<std::function<void()>> callback_;
};

}  // namespace rclcpp

#define STAND_IN_LOG(level, logger, ...)                            \
  do {                                                              \
    std::fprintf(stderr, "[" level "] [%s]: ", (logger).get_name()); \
    std::fprintf(stderr, __VA_ARGS__);                              \
    std::fputc('\n', stderr);                                       \
  } while (0)
#define RCLCPP_INFO(logger, ...) STAND_IN_LOG("INFO", logger, __VA_ARGS__)
#define RCLCPP_WARN(logger, ...) STAND_IN_LOG("WARN", logger, __VA_ARGS__)
#define RCLCPP_ERROR(logger, ...) STAND_IN_LOG("ERROR", logger, __VA_ARGS__)

#endif  // PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_RCLCPP_HPP_
