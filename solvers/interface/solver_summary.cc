#include "plumbline/solvers/interface/solver_summary.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <cstdio>

namespace plumbline {
namespace {

std::string Format(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string Format(const char* format, ...) {
  char buffer[512];
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof(buffer), format, arguments);
  va_end(arguments);
  return buffer;
}

std::string TermRow(const TermSummary& summary) {
  const double rms = summary.WhitenedRms();
  std::string row = Format("  %-14s %10zu %14.6e %14.6e %9.3f", summary.name.c_str(), summary.count,
                           summary.initial_cost, summary.final_cost, rms);
  if (summary.sigma > 0.0) row += Format(" %10.5f %s", rms * summary.sigma, summary.unit.c_str());
  return row + "\n";
}

}  // namespace

double TermSummary::WhitenedRms() const {
  const double num_residuals = static_cast<double>(count) * residuals_per_block;
  return num_residuals > 0.0 ? std::sqrt(2.0 * final_cost / num_residuals) : 0.0;
}

const char* ToString(TerminationType type) {
  switch (type) {
    case TerminationType::kFailure:
      return "failure";
    case TerminationType::kNoImprovement:
      return "no improvement";
    case TerminationType::kUserStopped:
      return "stopped";
    case TerminationType::kMaxIterations:
      return "max iterations";
    case TerminationType::kConverged:
      return "converged";
  }
  return "";
}

std::string ProgressHeader() {
  return "iter round phase         cost cost_change |gradient|   |step| step_size     beta  "
         "tr_ratio tr_radius evals iter_time total_time";
}

std::string ProgressRow(const IterationSummary& it) {
  return Format("%4d %5d %-5s %12.6e %11.3e %10.2e %8.2e %9.2e %8.2e %9.2e %9.2e %5d %9.3f %10.2f",
                it.iteration, it.round, it.phase.c_str(), it.cost, it.cost_change,
                it.gradient_max_norm, it.step_norm, it.step_size, it.beta, it.trust_region_ratio,
                it.trust_region_radius, it.evaluations, it.iteration_time_s, it.total_time_s);
}

std::string SolverSummary::BriefReport() const {
  if (num_relative_poses > 0) {
    return Format(
        "%s: %s in %.2f s, %zu iterations, %zu poses, %zu relative poses, chi2 %.6e -> %.6e",
        solver.c_str(), ToString(termination), total_time_s, iterations.size(), num_poses,
        num_relative_poses, seed_chi2, final_chi2);
  }
  return Format(
      "%s: %s in %.2f s, %zu rounds, %zu iterations, %zu poses, %zu points, energy %.6e -> %.6e",
      solver.c_str(), ToString(termination), total_time_s, rounds.size() + landmark_rounds.size(),
      iterations.size(), num_poses, num_points, acceptance.seed_energy, acceptance.final_energy);
}

std::string SolverSummary::RoundTable() const {
  std::string table = "Rounds (associations rebuilt in each)\n";
  table += landmark_rounds.empty()
               ? "  round radius_m  gate     lines  shape pairs   cost before    "
                 "cost after  iter  marginal\n"
               : "  round  gate   landmarks  observations   cost before    cost after  "
                 "returns moved [sigmas]\n";
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    const RoundSummary& round = rounds[i];
    table += Format("  %5zu %8.3f %5.2f %9zu %12zu %13.6e %13.6e %5d %.6e%s\n", i + 1,
                    round.radius_m, round.gate_sigmas, round.num_lines, round.num_shape_pairs,
                    round.initial_cost, round.final_cost, round.iterations, round.marginal_energy,
                    round.kept ? "" : " undone");
  }
  for (std::size_t i = 0; i < landmark_rounds.size(); ++i) {
    const LandmarkRoundSummary& round = landmark_rounds[i];
    table += Format("  %5zu %5.2f %11zu %13zu %13.6e %13.6e  %.3f\n", i + 1, round.gate_sigmas,
                    round.num_landmarks, round.num_observations, round.initial_cost,
                    round.final_cost, round.moved_sigmas);
  }
  return table;
}

std::vector<IgnoredEdge> SolverSummary::FarthestIgnoredEdges(std::size_t max_number) const {
  std::vector<IgnoredEdge> farthest = ignored_edges;
  std::stable_sort(farthest.begin(), farthest.end(),
                   [](const IgnoredEdge& a, const IgnoredEdge& b) { return a.sigmas > b.sigmas; });
  farthest.resize(std::min(farthest.size(), max_number));
  return farthest;
}

std::string SolverSummary::LocalReport() const {
  std::string report;
  if (!ignored_edges.empty()) {
    report += Format("  %zu relative poses are contradicted by their scans and did not count:\n",
                     ignored_edges.size());
  }
  constexpr std::size_t kMaxShown = 5;
  for (const IgnoredEdge& edge : FarthestIgnoredEdges(kMaxShown)) {
    report += Format("    %lld to %lld is %.2f m, %.3f rad, %.0f sigmas off the result\n",
                     edge.from, edge.to, edge.off_m, edge.off_rad, edge.sigmas);
  }
  if (ignored_edges.size() > kMaxShown) report += "    and others that are less far off\n";
  for (const DownweightedStep& downweighted : downweighted_steps) {
    report += Format("  Odometry step %zu is %.0f sigmas off the seed and was downweighted.\n",
                     downweighted.step, downweighted.sigma_factor);
  }
  for (const WorseStretch& stretch : put_back) {
    report += Format(
        "  Poses %d to %d were put back as the seed has them: held-out error %.2f -> "
        "%.2f sigmas^2 otherwise.\n",
        stretch.first, stretch.last, stretch.seed_error, stretch.state_error);
  }
  return report;
}

std::string SolverSummary::FullReport() const {
  const std::string end = Format("Termination: %s. ", ToString(termination)) + message + "\n";
  if (num_relative_poses > 0) return BriefReport() + "\n" + end;
  std::string report = BriefReport() + "\n\n" + RoundTable();
  if (!landmark_rounds.empty()) {
    report += Format(
        "  Points lie %.1f mm off their beams' ends in the mean, %.1f mm and %.2f of "
        "the beam's sigmas at most.\n",
        1e3 * displacements.mean_m, 1e3 * displacements.max_m, displacements.max_beam_sigmas);
  }
  report += Format(
      "\nAcceptance test                            seed          final\n"
      "  energy                        %13.6e  %13.6e\n"
      "  held-out error [sigmas^2]     %13.4f  %13.4f  (%zu returns; up to %.4f)\n",
      acceptance.seed_energy, acceptance.final_energy, acceptance.seed_held_out_error,
      acceptance.final_held_out_error, acceptance.num_held_out, acceptance.LargestHeldOutError());
  report += LocalReport();
  report +=
      "\nTerms, under the last associations\n"
      "  term                count    cost before     cost after  RMS (whitened, in units)\n";
  for (const TermSummary& term : terms) report += TermRow(term);
  report += Format("\nTime [s]: association %.2f, setup %.2f, minimisation %.2f, total %.2f\n",
                   association_time_s, setup_time_s, solve_time_s, total_time_s);
  return report + end;
}

}  // namespace plumbline
