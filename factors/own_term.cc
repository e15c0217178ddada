#include "plumbline/factors/own_term.h"

#include <ceres/cost_function.h>

#include <algorithm>
#include <cstdint>

#include "plumbline/core/options_check.h"

namespace plumbline {
namespace {

template <typename Id>
bool IsRepeated(std::vector<Id> ids) {
  std::sort(ids.begin(), ids.end());
  return std::adjacent_find(ids.begin(), ids.end()) != ids.end();
}

// What is wrong with a residual; empty: nothing. num_rows: of the first one.
std::string Fault(const OwnResidual& residual, int num_rows) {
  if (residual.cost == nullptr) return "has no cost function";
  if (residual.poses.empty() && residual.points.empty()) return "sees neither a pose nor a point";
  if (IsRepeated(residual.poses) || IsRepeated(residual.points)) return "sees a block twice";
  std::vector<std::int32_t> sizes(residual.poses.size(), 3);
  sizes.resize(sizes.size() + residual.points.size(), 2);
  if (residual.cost->parameter_block_sizes() != sizes) {
    std::string text = "sees " + std::to_string(residual.poses.size()) + " poses and " +
                       std::to_string(residual.points.size()) +
                       " points, blocks of 3 and 2, but its cost function has blocks of";
    for (const int size : residual.cost->parameter_block_sizes()) {
      text += " " + std::to_string(size);
    }
    return text;
  }
  if (residual.cost->num_residuals() < 1) return "has no rows";
  if (residual.cost->num_residuals() != num_rows) {
    return "has " + std::to_string(residual.cost->num_residuals()) + " rows, but the first one " +
           std::to_string(num_rows);
  }
  return "";
}

}  // namespace

bool OwnTerm::SeesPoints() const {
  return std::any_of(residuals.begin(), residuals.end(),
                     [](const OwnResidual& residual) { return !residual.points.empty(); });
}

bool OwnTerm::Check(std::string* error) const {
  const auto refuse = [error](const std::string& reason) {
    if (error != nullptr) *error = reason;
    return false;
  };
  if (name.empty()) return refuse("an own term has no name");
  PLUMBLINE_CHECK_FINITE_OPTION(sigma, >=, 0.0);
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const auto& first = residuals.front().cost;
    const std::string fault = Fault(residuals[i], first == nullptr ? 0 : first->num_residuals());
    if (!fault.empty()) {
      return refuse("own term \"" + name + "\": residual " + std::to_string(i) + " " + fault);
    }
  }
  return true;
}

}  // namespace plumbline
