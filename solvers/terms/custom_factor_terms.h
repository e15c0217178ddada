#ifndef PLUMBLINE_SOLVERS_TERMS_CUSTOM_FACTOR_TERMS_H_
#define PLUMBLINE_SOLVERS_TERMS_CUSTOM_FACTOR_TERMS_H_

#include <cstddef>
#include <optional>
#include <vector>

#include "plumbline/core/custom_factor.h"
#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/solvers/terms/term.h"

namespace plumbline {

/// Factors as terms of the energy, one per name, in the order in which the names come.
TermList MakeFactorTerms(const std::vector<CustomFactor>& factors);

/// Where factors hold the map in some directions only, as a compass does: a factor that holds the
/// first pose in the others, at its initial guess. It costs nothing at the optimum.
std::optional<CustomFactor> GaugeFactor(const SlamGraph& graph);

/// The factors of a graph as terms, with its GaugeFactor.
TermList MakeFactorTerms(const SlamGraph& graph);

/// InvalidArgument names the first factor, from index `first` on, that is not finite or has no
/// finite derivatives at this state, of the graph's size. Factors that see points are left out if
/// the state has none.
Status CheckFactors(const SlamGraph& graph, const MapState& state, std::size_t first = 0);

/// One half of the squares of factors that see points, with every point at the measured end of its
/// beam; NaN where one is undefined. 0 without such factors.
double FactorPointCost(const SlamGraph& graph, const std::vector<double>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_TERMS_CUSTOM_FACTOR_TERMS_H_
