// Topics, services, timers and components of this process. Messages are delivered in the thread
// that publishes them.
#ifndef PLUMBLINE_TEST_APPS_ROS2_STAND_IN_BUS_HPP_
#define PLUMBLINE_TEST_APPS_ROS2_STAND_IN_BUS_HPP_

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <rclcpp/qos.hpp>
#include <stdexcept>
#include <string>
#include <typeindex>
#include <vector>

namespace stand_in {

/// The end of a topic or service that is called; the type tells its arguments.
struct Receiver {
  std::string name;
  std::type_index type;
  rclcpp::QoS qos;
  std::function<void(const void*)> take;
};

class Bus {
 public:
  static Bus& Instance() {
    static Bus bus;
    return bus;
  }

  static std::string Absolute(const std::string& name) {
    if (name.empty()) throw std::invalid_argument("the name of a topic is empty");
    return name.front() == '/' ? name : "/" + name;
  }

  /// The receiver is there until its pointer goes.
  void Add(const std::shared_ptr<Receiver>& receiver) {
    std::shared_ptr<const void> latched;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      receivers_.push_back(receiver);
      const auto found = latched_.find(receiver->name);
      if (found != latched_.end() && receiver->qos.is_transient_local()) latched = found->second;
    }
    if (latched != nullptr) receiver->take(latched.get());
  }

  /// False if nobody receives.
  template <typename Message>
  bool Send(const std::string& name, const rclcpp::QoS& qos, const Message& message) {
    std::vector<std::shared_ptr<Receiver>> receivers;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (qos.is_transient_local()) latched_[name] = std::make_shared<const Message>(message);
      for (const auto& weak : receivers_) {
        const auto receiver = weak.lock();
        if (receiver == nullptr || receiver->name != name) continue;
        if (receiver->type != typeid(Message)) throw std::logic_error(name + ": another type");
        if (receiver->qos.Accepts(qos)) receivers.push_back(receiver);
      }
    }
    for (const auto& receiver : receivers) receiver->take(&message);
    return !receivers.empty();
  }

  void AddTimer(const std::shared_ptr<std::function<void()>>& timer) { timers_.push_back(timer); }
  /// Lets the time come of all timers once.
  void FireTimers() {
    const auto timers = timers_;
    for (const auto& weak : timers) {
      if (const auto timer = weak.lock()) (*timer)();
    }
  }

 private:
  std::mutex mutex_;
  std::vector<std::weak_ptr<Receiver>> receivers_;
  std::map<std::string, std::shared_ptr<const void>> latched_;
  std::vector<std::weak_ptr<std::function<void()>>> timers_;
};

}  // namespace stand_in

#endif  // PLUMBLINE_TEST_APPS_ROS2_STAND_IN_BUS_HPP_
