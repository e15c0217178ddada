# Warnings, sanitizers and what makes gcc faster, for our own targets, never for those who link to us.
option(PLUMBLINE_WERROR "Treat warnings as errors" OFF)
set(PLUMBLINE_SANITIZE "" CACHE STRING "Sanitizers to build with, e.g. address,undefined")
if(PLUMBLINE_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "PLUMBLINE_BUILD_FUZZERS needs -DCMAKE_CXX_COMPILER=clang++")
  endif()
  set(PLUMBLINE_SANITIZE fuzzer-no-link,address,undefined)
endif()

function(plumbline_private_options target)
  # gcc would spend a tenth of its time or more on getting memory back that it needs no more. For
  # 10 % more memory it yields the same objects.
  target_compile_options(${target} PRIVATE
                         $<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000>)
  target_compile_options(${target} PRIVATE -Wall -Wextra $<$<BOOL:${PLUMBLINE_WERROR}>:-Werror>)
  if(PLUMBLINE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${PLUMBLINE_SANITIZE}
                           -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${PLUMBLINE_SANITIZE})
  endif()
  if(PLUMBLINE_SANITIZE MATCHES "address")
    # Under this sanitizer Eigen would allocate in another way than inside the system's libceres,
    # and memory that one allocates and the other frees shows as a false heap error.
    target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
endfunction()
