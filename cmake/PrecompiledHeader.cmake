# Nearly every source of ours includes Eigen, and reading it is a good part of what most of them
# take. So each target reads it once. Nothing but Eigen belongs here: what a header of ours forgets
# to include must not be there by chance.

# For our own targets only, never in the build of those who take the tree in.
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON turns it off. With a second target, which has to have the
# same compile options, what that one has read serves both.
function(plumbline_precompile_eigen target)
  if(NOT PLUMBLINE_TOP_LEVEL)
    return()
  endif()
  if(ARGC GREATER 1)
    target_precompile_headers(${target} REUSE_FROM ${ARGV1})
  else()
    target_precompile_headers(${target} PRIVATE <Eigen/Core>)
  endif()
endfunction()
