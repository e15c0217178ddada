#include "plumbline/solvers/hypotheses/odometry_heading_start.h"

#include <utility>

#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/front_end/odometry_headings.h"
#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/loop_closure/suspect_edges.h"

namespace plumbline {
namespace {

class OdometryHeadingStart : public Proposer {
 public:
  std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* context) override {
    const SlamGraph& graph = context->surfaces.graph();
    if (LacksOdometry(graph) || context->has_sessions || best.start != context->matched ||
        !context->matched->given_poses.empty() ||
        !context->posterior.IsSuspicious(best.consistency)) {
      return {};
    }
    Proposal turned;
    turned.id = "odometry headings";
    MapHypothesis& draft = turned.draft;
    draft.kind = HypothesisKind::kOdometryHeadings;
    // The odometry as given: the errors found in it were told from this matching, and may be the
    // drift of the matching.
    SequentialTrajectory start =
        WithOdometryHeadings(*context->matched, PosesOf(graph.initial_poses()), context->motion);
    draft.keys = MakeKeyframeGraph(start, context->motion);
    MarkSuspectEdges(context->surfaces, start.world_from_robot, context->pool, &draft.keys);
    draft.start = std::make_shared<const SequentialTrajectory>(std::move(start));
    return {std::move(turned)};
  }
};

}  // namespace

std::unique_ptr<Proposer> ProposeOdometryHeadings() {
  return std::make_unique<OdometryHeadingStart>();
}

}  // namespace plumbline
