#ifndef PLUMBLINE_APPS_PYTHON_OBJECTS_H_
#define PLUMBLINE_APPS_PYTHON_OBJECTS_H_

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <utility>
#include <vector>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"

namespace plumbline {

/// A graph as Python has it.
class GraphObject {
 public:
  GraphObject() = default;
  explicit GraphObject(SlamGraph graph) : graph_(std::move(graph)) {}

  const SlamGraph& operator*() const { return graph_; }
  const SlamGraph* operator->() const { return &graph_; }
  /// To be changed. UnavailableError while the library reads it without Python's lock: for a
  /// callback, or another thread.
  SlamGraph* Mutable();

  /// Calls work(graph) without Python's lock. The graph cannot change meanwhile.
  template <typename Work>
  auto ReadUnlocked(const Work& work) const {
    const Reader reader(this);
    const pybind11::gil_scoped_release unlocked;
    return work(graph_);
  }

 private:
  class Reader {
   public:
    explicit Reader(const GraphObject* graph) : graph_(graph) { ++graph_->num_readers_; }
    ~Reader() { --graph_->num_readers_; }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

   private:
    const GraphObject* graph_;
  };

  SlamGraph graph_;
  mutable int num_readers_ = 0;  // counted with Python's lock held
};

/// A state as Python has it: two arrays, whose views outlive it. The library works on a copy and
/// writes the result into the same arrays, so views see it.
struct StateObject {
  StateObject() : StateObject(MapState()) {}
  explicit StateObject(MapState state);

  pybind11::array poses;   ///< of shape (N, 3)
  pybind11::array points;  ///< of shape (M, 2)

  /// A copy for the library. ValueError if somebody gave the arrays another shape or type.
  MapState State() const;
  /// The same, one of this graph: with InvalidArgumentError on another size.
  MapState StateOf(const SlamGraph& graph) const;
  /// That, and ValueError on numbers that are not finite or beyond 1e8.
  MapState FiniteStateOf(const SlamGraph& graph) const;
  /// That can be written back. ValueError if an array is read-only.
  MapState WritableStateOf(const SlamGraph& graph) const;
  /// Into the present arrays; into new ones where the size is another.
  void Write(MapState state);
};

/// MapState::poses from an argument of shape (N, 3): one finite pose per pose of the graph.
std::vector<double> PosesFor(const SlamGraph& graph, const pybind11::object& poses);

/// @{
/// The same of an array that the result is written into. ValueError unless it is of type float64,
/// row by row, and writable, and unless it still is, with the same size, when it is written.
std::vector<double> WritablePosesFor(const SlamGraph& graph, const pybind11::array& poses);
void WritePoses(const std::vector<double>& values, pybind11::array* poses);
/// @}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_PYTHON_OBJECTS_H_
