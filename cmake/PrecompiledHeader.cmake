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

# Sets `result` to those of the headers, paths inside the source tree `root`, that reach Eigen
# neither directly nor through each other. That a source which includes such a header first compiles
# does not show that the header does without Eigen.
function(plumbline_headers_without_eigen root headers result)
  foreach(header IN LISTS headers)
    file(STRINGS ${root}/${header} includes REGEX "^#include [\"<](plumbline|Eigen)/")
    list(TRANSFORM includes REPLACE "^#include [\"<](plumbline/)?([^\">]+).*" "\\2")
    set(includes_of_${header} ${includes})
  endforeach()
  set(with_eigen)
  set(found ON)
  while(found)
    set(found OFF)
    foreach(header IN LISTS headers)
      foreach(include IN LISTS includes_of_${header})
        if(include IN_LIST with_eigen OR include MATCHES "^Eigen/")
          list(APPEND with_eigen ${header})
          list(REMOVE_ITEM headers ${header})
          set(found ON)
          break()
        endif()
      endforeach()
    endforeach()
  endwhile()
  set(${result} ${headers} PARENT_SCOPE)
endfunction()
