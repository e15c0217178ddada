#ifndef PLUMBLINE_SOLVERS_TERMS_OWN_TERMS_H_
#define PLUMBLINE_SOLVERS_TERMS_OWN_TERMS_H_

#include <memory>

#include "plumbline/core/map_state.h"
#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"
#include "plumbline/factors/factor_options.h"
#include "plumbline/factors/own_term.h"
#include "plumbline/solvers/terms/term.h"

namespace plumbline {

/// A host's own term as one of the energy.
std::shared_ptr<const Term> MakeTerm(std::shared_ptr<const OwnTerm> term);

/// InvalidArgument names the own term and the residual that sees a pose or point that the graph
/// does not have. Needs terms that pass Check.
Status CheckOwnTermIds(const FactorOptions& options, const SlamGraph& graph);

/// The same for ids, and for residuals that are not finite or have no finite derivatives at this
/// state, of the graph's size.
Status CheckOwnTerms(const FactorOptions& options, const SlamGraph& graph, const MapState& state);

/// One half of the squares of own terms that see points, with every point at the measured end of
/// its beam. 0 without such terms.
double OwnPointCost(const FactorOptions& options, const SlamGraph& graph,
                    const std::vector<double>& poses);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_TERMS_OWN_TERMS_H_
