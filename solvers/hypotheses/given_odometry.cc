#include "plumbline/solvers/hypotheses/given_odometry.h"

#include <algorithm>
#include <utility>

#include "plumbline/solvers/front_end/motion_prediction.h"
#include "plumbline/solvers/loop_closure/close_loops.h"
#include "plumbline/solvers/loop_closure/suspect_edges.h"

namespace plumbline {
namespace {

// Loops are closed around the odometry only if passes in its map conflict by no more than this
// times the share that can be explained. Tuned on mit-killian, infinite-corridor, acapulco and
// fr-clinic.
constexpr double kSoundOdometry = 2.0;

class GivenOdometry : public Proposer {
 public:
  std::vector<Proposal> Propose(const MapHypothesis& best, SearchContext* context) override {
    const SlamGraph& graph = context->surfaces.graph();
    if (LacksOdometry(graph) || context->has_sessions) return {};
    std::vector<Proposal> proposals{MakeAlone(best, *context)};
    const MapHypothesis& alone = proposals.front().draft;
    const FreeSpaceConflict& passes = alone.consistency.between_passes;
    const Posterior& posterior = context->posterior;
    if (passes.num_compared > 0 &&
        passes.Share() <= kSoundOdometry * posterior.explicable_share() &&
        posterior.IsSuspicious(best.consistency)) {
      Proposal closed;
      closed.id = "odometry";
      closed.draft.kind = HypothesisKind::kOdometry;
      closed.draft.start = alone.start;
      closed.draft.keys = alone.keys;
      proposals.push_back(std::move(closed));
    }
    return proposals;
  }

 private:
  static bool HasUntiedStep(const LoopClosingReport& loops) {
    return std::any_of(loops.suspect_steps.begin(), loops.suspect_steps.end(),
                       [](const SuspectStep& suspect) { return suspect.IsUntied(); });
  }

  // No closure ties anything to the odometry, so steps that the scans contradict stay open.
  static void MarkUntiedSteps(const SearchContext& context, MapHypothesis* alone) {
    MarkSuspectEdges(context.surfaces, alone->world_from_robot, context.pool, &alone->keys);
    for (const SequentialEdge& edge : alone->keys.sequential) {
      SuspectStep suspect;
      suspect.first_pose_after = edge.first_pose_after;
      suspect.evidence = edge.evidence;
      if (suspect.IsUntied()) alone->loops.suspect_steps.push_back(suspect);
    }
  }

  static Proposal MakeAlone(const MapHypothesis& best, const SearchContext& context) {
    Proposal alone;
    alone.id = "odometry alone";
    MapHypothesis& draft = alone.draft;
    draft.kind = HypothesisKind::kOdometryAlone;
    SequentialTrajectory odometry = *context.matched;
    odometry.world_from_robot = PosesOf(context.surfaces.graph().initial_poses());
    draft.keys = MakeKeyframeGraph(odometry, context.motion);
    draft.world_from_robot = odometry.world_from_robot;
    if (HasUntiedStep(best.loops)) MarkUntiedSteps(context, &draft);
    draft.start = std::make_shared<const SequentialTrajectory>(std::move(odometry));
    draft.consistency = context.meter.Measure(draft.world_from_robot, context.pool);
    alone.is_complete = true;
    return alone;
  }
};

}  // namespace

std::unique_ptr<Proposer> ProposeGivenOdometry() { return std::make_unique<GivenOdometry>(); }

}  // namespace plumbline
