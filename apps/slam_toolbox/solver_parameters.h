#ifndef PLUMBLINE_APPS_SLAM_TOOLBOX_SOLVER_PARAMETERS_H_
#define PLUMBLINE_APPS_SLAM_TOOLBOX_SOLVER_PARAMETERS_H_

#include <plumbline/factors/factor_options.h>
#include <plumbline/solvers/interface/solver_options.h>

#include <cstdint>
#include <rclcpp/rclcpp.hpp>
#include <string>
#include <type_traits>

namespace plumbline {

/// Declares a parameter of a ROS node, unless the node has it, and gives its value. Value: bool,
/// double or std::int64_t.
template <typename Value, typename Host>
Value DeclareParameter(Host* host, const std::string& name, Value fallback) {
  // A stand-in of rclcpp, for karto without ROS, may know no integers.
  if constexpr (!std::is_constructible_v<rclcpp::ParameterValue, Value>) {
    return fallback;
  } else {
    if (!host->has_parameter(name)) {
      host->declare_parameter(name, rclcpp::ParameterValue(fallback));
    }
    const auto parameter = host->get_parameter(name);
    if constexpr (std::is_same_v<Value, bool>) {
      return parameter.as_bool();
    } else if constexpr (std::is_same_v<Value, double>) {
      return parameter.as_double();
    } else {
      return parameter.as_int();
    }
  }
}

/// Declares the parameters of the README with the defaults of the library, and reads them. Their
/// values may be out of range.
template <typename Host>
SolverOptions DeclareParameters(Host* host) {
  SolverOptions options;
  const auto take = [host](const char* name, double* value) {
    *value = DeclareParameter(host, name, *value);
  };
  take("plumbline.sigma_range_m", &options.factors.beam.sigma_range_m);
  take("plumbline.sigma_bearing_rad", &options.factors.beam.sigma_bearing_rad);
  take("plumbline.sigma_manifold_m", &options.factors.manifold.sigma_m);
  options.test_edges = DeclareParameter(host, "plumbline.test_edges", options.test_edges);
  options.num_threads = static_cast<int>(
      DeclareParameter<std::int64_t>(host, "plumbline.threads", options.num_threads));
  return options;
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SLAM_TOOLBOX_SOLVER_PARAMETERS_H_
