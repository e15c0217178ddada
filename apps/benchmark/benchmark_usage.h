#ifndef PLUMBLINE_APPS_BENCHMARK_BENCHMARK_USAGE_H_
#define PLUMBLINE_APPS_BENCHMARK_BENCHMARK_USAGE_H_

namespace plumbline {

/// What --help of plumbline_benchmark says before the flags.
constexpr char kBenchmarkUsage[] =
    "Runs an experiment and sums up what came of it.\n\n"
    "  seeding_study      right maps and alarms over many simulated drives, most of them with a "
    "fault\n"
    "  sessions_study     drives on several days through one building, and one through another: "
    "are "
    "they tied right?\n"
    "  variations         variations of real logs with known relative poses: is each map as good "
    "as "
    "that of the unvaried log?\n"
    "  solver_comparison  the solvers of --solvers from one start: energy over time, memory, map "
    "quality\n"
    "  scaling            time and memory of the joint estimation alone, over the size of a "
    "simulated building\n"
    "  log                baselines, seed and result on a log: maps, relations, sharpness\n"
    "  synthetic          pose and map errors of several algorithms on short drives with few "
    "scans\n"
    "  ablation           what each part of the joint estimation contributes, on these drives, "
    "on simulated buildings and on a log\n"
    "  online             OnlineMapper fed scan by scan: error of the poses when they are given, "
    "time per scan, lag, memory, and the final map\n"
    "  replay             the incremental solver on a drive whose scans were matched: time of each "
    "solve, and how the end compares to solving all at once\n"
    "  scan_solver        the calls of a mapper as slam_toolbox to its scan solver: time of "
    "each\n"
    "  adversarial        falsified graphs and logs of simulated buildings: is any result worse "
    "than its start?\n"
    "  sensors            fields of view, ranges, noise, mountings, moving things, glass and "
    "other buildings, each against the truth\n"
    "  profile            time of each stage of a run over a log, and how far it is from the "
    "time to move its bytes\n\n"
    "  plumbline_benchmark --experiment=seeding_study --buildings=180 --csv=seeding_study.csv\n"
    "  plumbline_benchmark --experiment=sessions_study --buildings=24 --csv=sessions_study.csv\n"
    "  plumbline_benchmark --experiment=variations --log=fr079.clf.gz,intel.clf.gz "
    "--csv=variations.csv\n"
    "  plumbline_benchmark --experiment=solver_comparison --log=fr079.clf.gz "
    "--relations=fr079.relations --output_dir=out\n"
    "  plumbline_benchmark --experiment=solver_comparison --start=icp --output_dir=out "
    "--solvers=reduced,ceres:reduced:lbfgs,ceres:iterative_schur:schur_jacobi,pose_graph\n"
    "  plumbline_benchmark --experiment=scaling --scans=1000,10000 --csv=scaling.csv\n"
    "  plumbline_benchmark --experiment=synthetic,log,ablation --log=fr079.clf.gz "
    "--relations=fr079.relations --output_dir=out\n"
    "  plumbline_benchmark --experiment=online --log=fr079.clf.gz --relations=fr079.relations "
    "--output_dir=out\n"
    "  plumbline_benchmark --experiment=replay --log=fr079.clf.gz --output_dir=out\n"
    "  plumbline_benchmark --experiment=scan_solver --graph=intel.g2o --log=intel.clf.gz "
    "--relations=intel.relations\n"
    "  plumbline_benchmark --experiment=adversarial --seeds=5 --csv=adversarial.csv\n"
    "  plumbline_benchmark --experiment=sensors --output_dir=out\n"
    "  plumbline_benchmark --experiment=profile --log=fr079.clf.gz --output_dir=out";

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_BENCHMARK_BENCHMARK_USAGE_H_
