#ifndef PLUMBLINE_SOLVERS_POSE_GRAPH_UNCERTAIN_EDGES_H_
#define PLUMBLINE_SOLVERS_POSE_GRAPH_UNCERTAIN_EDGES_H_

namespace plumbline {

/// The scale of the Cauchy loss of edges that may be wrong, in standard deviations: beyond it an
/// edge gives way.
inline constexpr double kCauchyScale = 3.0;

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_POSE_GRAPH_UNCERTAIN_EDGES_H_
