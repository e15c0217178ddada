cmake_policy(VERSION 3.18)  # Scripts that install have none of their own.

# The headers that a user of the library may need to know: README.md and the API reference list the
# same ones, and what they include is installed with them.
set(PLUMBLINE_PUBLIC_HEADERS
  core/status.h
  core/pose2.h
  core/laser_scan.h
  core/map_state.h
  core/slam_graph.h
  factors/factor_options.h
  solvers/map_log.h
  solvers/solver_options.h
  solvers/solver_summary.h
  solvers/solve.h
  solvers/sliding_window.h
  solvers/covariance.h
  solvers/calibration.h
  solvers/seeding/seed.h)
# Those for a host with a solver of its own, and for Ceres' switches. solvers/README.md has them.
set(PLUMBLINE_EXTRA_HEADERS
  solvers/rounds_solver.h
  solvers/ceres_options.h)

# Sets `result` to these headers and all headers of ours that they include, directly or not, as
# paths inside the source tree `root`.
function(plumbline_reached_headers root result)
  set(reached)
  set(queue ${PLUMBLINE_PUBLIC_HEADERS} ${PLUMBLINE_EXTRA_HEADERS})
  while(queue)
    list(POP_FRONT queue header)
    if(header IN_LIST reached)
      continue()
    endif()
    list(APPEND reached ${header})
    file(STRINGS ${root}/${header} includes REGEX "^#include \"plumbline/")
    list(TRANSFORM includes REPLACE "^#include \"plumbline/([^\"]+)\".*" "\\1")
    list(APPEND queue ${includes})
  endwhile()
  list(SORT reached)
  set(${result} ${reached} PARENT_SCOPE)
endfunction()
