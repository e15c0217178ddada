cmake_policy(VERSION 3.18)  # Scripts that install have none of their own.

# The headers to begin with, as README.md lists them.
set(PLUMBLINE_DOORS
  core/status.h
  core/pose2.h
  core/laser_scan.h
  core/slam_graph.h
  core/map_state.h
  factors/factor_options.h
  solvers/map_log.h
  solvers/seed.h
  solvers/solve.h
  solvers/online_mapper.h
  solvers/covariance.h
  solvers/calibration.h
  solvers/interface/solver_options.h
  solvers/interface/solver_summary.h)
# All public headers: these, and the data that they take and give. The API reference lists them.
set(PLUMBLINE_PUBLIC_HEADERS ${PLUMBLINE_DOORS}
  core/angle.h
  core/custom_factor.h
  core/measured_surface.h
  core/measurements.h
  core/options_check.h
  core/pose_frame.h
  core/return_normal.h
  core/scan_returns.h
  solvers/alarm.h
  solvers/interface/acceptance.h
  solvers/interface/association_options.h
  solvers/interface/built_in_solvers.h
  solvers/interface/map_consistency.h
  solvers/interface/odometry_report.h
  solvers/interface/seeding_options.h
  solvers/interface/seeding_report.h)
# The header of plumbline::io, a component of its own.
set(PLUMBLINE_IO_HEADERS apps/readers/log_files.h)
# Headers for a host with a front end, a solver, a residual or a reader of logs of its own, for Ceres' switches, for
# several drives, and for a window of poses that is solved like a map. Also listed in the API
# reference; solvers/README.md says how to use them.
set(PLUMBLINE_EXTENSION_HEADERS
  core/no_return_level.h
  core/thread_pool.h
  factors/analytic_factor_forward.h
  factors/manifold_factor.h
  factors/shape_factor.h
  solvers/association/associations.h
  solvers/association/tangent_lines.h
  solvers/full/energy.h
  solvers/full/rounds_solver.h
  solvers/incremental_solver.h
  solvers/interface/ceres_options.h
  solvers/interface/inner_result.h
  solvers/interface/session_report.h
  solvers/interface/solver.h
  solvers/map_sessions.h
  solvers/pose_graph/pose_graph.h
  solvers/sliding_window.h
  solvers/terms/term.h)
