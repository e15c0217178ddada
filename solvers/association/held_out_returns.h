#ifndef PLUMBLINE_SOLVERS_ASSOCIATION_HELD_OUT_RETURNS_H_
#define PLUMBLINE_SOLVERS_ASSOCIATION_HELD_OUT_RETURNS_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// Of each scan every 16th return is held out: surfaces and poses are found without these, and then
/// judged by them. Single returns, not stretches: neighbours of one scan share the error of its
/// pose, which is what they are to tell of, but not the noise of their ranges, which a pose may
/// have been fitted to. Where the count begins jumps from scan to scan, so that all directions
/// have their turn, also where a robot's lasers scan by turns.
struct HeldOutReturns {
  static constexpr std::size_t kOneIn = 16;

  /// Of a scan: the first of its returns that is held out, counted from 0. The same whichever
  /// process has the scan.
  static std::size_t FirstOf(const SlamGraph& graph, int scan_id) {
    return FirstOf(graph.IdAmongAll(scan_id));
  }
  static std::size_t FirstOf(int id_among_all) {
    // The upper bits of a product with 2^32 / golden ratio: close ids get values far apart.
    const std::uint32_t mixed = static_cast<std::uint32_t>(id_among_all) * 2654435769u;
    return mixed / (0xffffffffu / kOneIn + 1);
  }

  /// Whether they contain the k-th return of a scan, whose first one is FirstOf it.
  static bool Contain(std::size_t k, std::size_t first) { return k % kOneIn == first; }
  /// How many a scan has.
  static std::size_t CountOf(const SlamGraph& graph, int scan_id) {
    const std::size_t first = FirstOf(graph, scan_id), end = graph.scan(scan_id).num_returns;
    return first < end ? (end - first + kOneIn - 1) / kOneIn : 0;
  }

  /// Calls body(return id) for each of a scan, in order.
  template <typename Body>
  static void ForEachOf(const SlamGraph& graph, int scan_id, const Body& body) {
    const ScanEntry& scan = graph.scan(scan_id);
    for (std::size_t k = FirstOf(graph, scan_id); k < scan.num_returns; k += kOneIn) {
      body(scan.first_return + k);
    }
  }
};

/// One value per return of the graph, with `without` in place of those that are held out.
template <typename Value>
std::vector<Value> WithoutHeldOut(const SlamGraph& graph, std::vector<Value> of_return,
                                  const Value& without) {
  for (int s = 0; s < graph.num_scans(); ++s) {
    HeldOutReturns::ForEachOf(graph, s, [&](std::size_t r) { of_return[r] = without; });
  }
  return of_return;
}

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_ASSOCIATION_HELD_OUT_RETURNS_H_
