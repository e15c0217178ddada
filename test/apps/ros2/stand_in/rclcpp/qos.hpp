// Stands in for rclcpp's quality of service.
#ifndef PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_QOS_HPP_
#define PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_QOS_HPP_

#include <cstddef>

namespace rclcpp {

class QoS {
 public:
  QoS(std::size_t history_depth) : depth_(history_depth) {}
  QoS& keep_last(std::size_t depth) {
    depth_ = depth;
    return *this;
  }
  QoS& best_effort() {
    is_reliable_ = false;
    return *this;
  }
  QoS& transient_local() {
    is_transient_local_ = true;
    return *this;
  }

  bool is_transient_local() const { return is_transient_local_; }
  /// Whether a subscription of this quality matches a publisher.
  bool Accepts(const QoS& offered) const {
    return (offered.is_reliable_ || !is_reliable_) &&
           (offered.is_transient_local_ || !is_transient_local_);
  }

 private:
  std::size_t depth_;
  bool is_reliable_ = true, is_transient_local_ = false;
};

class SensorDataQoS : public QoS {
 public:
  SensorDataQoS() : QoS(5) { best_effort(); }
};

}  // namespace rclcpp

#endif  // PLUMBLINE_TEST_APPS_ROS2_STAND_IN_RCLCPP_QOS_HPP_
