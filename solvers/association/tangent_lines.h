#ifndef PLUMBLINE_SOLVERS_ASSOCIATION_TANGENT_LINES_H_
#define PLUMBLINE_SOLVERS_ASSOCIATION_TANGENT_LINES_H_

#include <cstddef>
#include <utility>
#include <vector>

#include "plumbline/factors/manifold_factor.h"

namespace plumbline {

/// The tangent line that draws each return, if there is one. Returns of one surface share theirs:
/// a number per return is a sixth of the memory of a line per return.
class TangentLines {
 public:
  static constexpr int kNone = -1;  ///< number of no line

  TangentLines() = default;
  /// No return has a line.
  explicit TangentLines(std::size_t num_returns) : line_of_return_(num_returns, kNone) {}
  /// lines: those with the zero normal are none. line_of_return: numbers of lines, or kNone.
  TangentLines(std::vector<TangentLine> lines, std::vector<int> line_of_return)
      : lines_(std::move(lines)), line_of_return_(std::move(line_of_return)) {}

  /// Number of returns.
  std::size_t size() const { return line_of_return_.size(); }

  /// The line of a return; one with the zero normal if it has none.
  const TangentLine& operator[](std::size_t return_id) const {
    static constexpr TangentLine kNoLine{0.0, 0.0, 0.0};
    const int number = line_of_return_[return_id];
    return number == kNone ? kNoLine : lines_[static_cast<std::size_t>(number)];
  }
  /// Whether the return has a line.
  bool HasLine(std::size_t return_id) const {
    const TangentLine& line = (*this)[return_id];
    return line.normal_x != 0.0 || line.normal_y != 0.0;
  }
  /// Returns with a line.
  std::size_t CountReturns() const {
    std::size_t count = 0;
    for (std::size_t r = 0; r < size(); ++r) count += HasLine(r);
    return count;
  }

  /// Number of lines, which count from 0.
  int num_lines() const { return static_cast<int>(lines_.size()); }
  /// Gives the number of the new line.
  int Add(const TangentLine& line) {
    lines_.push_back(line);
    return num_lines() - 1;
  }
  /// Gives a return the line of this number, or none (kNone).
  void Assign(std::size_t return_id, int number) { line_of_return_[return_id] = number; }

 private:
  std::vector<TangentLine> lines_;
  std::vector<int> line_of_return_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ASSOCIATION_TANGENT_LINES_H_
