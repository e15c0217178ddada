# cmake -D ROOT=... -D PREFIX=... -D LIBDIR=... -D COMPILER=... -D WORK=...
#       -P public_headers_test.cmake
cmake_minimum_required(VERSION 3.18)
include(${ROOT}/cmake/PublicHeaders.cmake)

function(expect_same what actual expected)
  list(SORT actual)
  list(SORT expected)
  if(NOT actual STREQUAL expected)
    message(SEND_ERROR "${what} has: ${actual}\nbut it should have: ${expected}")
  endif()
endfunction()

list(LENGTH PLUMBLINE_PUBLIC_HEADERS count)
if(count GREATER 14)
  message(SEND_ERROR "${count} public headers are more than anyone wants to know")
endif()

# The tables of README.md and of the API reference.
foreach(page README.md cmake/api_main_page.md)
  file(STRINGS ${ROOT}/${page} rows REGEX "^[|] `?(core|factors|solvers)/[a-z0-9_/]+[.]h`? [|]")
  list(TRANSFORM rows REPLACE "^[|] `?([a-z0-9_/]+[.]h).*" "\\1")
  expect_same(${page} "${rows}" "${PLUMBLINE_PUBLIC_HEADERS}")
endforeach()

plumbline_reached_headers(${ROOT} reached)
file(GLOB_RECURSE installed RELATIVE ${PREFIX}/include/plumbline ${PREFIX}/include/plumbline/*)
expect_same("the installed tree" "${installed}" "${reached}")

# All of them, and what the examples need, compile from the installed tree.
set(ENV{PKG_CONFIG_PATH} ${PREFIX}/${LIBDIR}/pkgconfig)
execute_process(COMMAND pkg-config --cflags plumbline OUTPUT_VARIABLE flags RESULT_VARIABLE result
                OUTPUT_STRIP_TRAILING_WHITESPACE)
if(result)
  message(FATAL_ERROR "pkg-config does not know plumbline")
endif()
separate_arguments(flags UNIX_COMMAND "${flags}")
set(text)
foreach(header IN LISTS PLUMBLINE_PUBLIC_HEADERS)
  string(APPEND text "#include <plumbline/${header}>\n")
endforeach()
file(WRITE ${WORK}/all_headers.cc "${text}")
execute_process(COMMAND ${COMPILER} -std=c++17 -M ${flags} ${WORK}/all_headers.cc
                OUTPUT_VARIABLE includes)
if(includes MATCHES "/ceres/")
  message(SEND_ERROR "the public headers include Ceres, which is for PLUMBLINE_EXTRA_HEADERS only")
endif()
set(text)
foreach(header IN LISTS PLUMBLINE_EXTRA_HEADERS)
  string(APPEND text "#include <plumbline/${header}>\n")
endforeach()
file(WRITE ${WORK}/extra_headers.cc "${text}")
file(GLOB examples ${ROOT}/apps/examples/*.cc)
foreach(source ${WORK}/all_headers.cc ${WORK}/extra_headers.cc ${examples})
  file(STRINGS ${source} needs_rosbag REGEX "^#include <rosbag/")
  if(needs_rosbag)  # compiled with the programs, where there is the library for it
    continue()
  endif()
  execute_process(COMMAND ${COMPILER} -std=c++17 -fsyntax-only ${flags} ${source}
                  RESULT_VARIABLE result)
  if(result)
    message(SEND_ERROR "${source} does not compile with what is installed")
  endif()
  # Examples show what is installed only.
  file(STRINGS ${source} includes REGEX "^#include <plumbline/")
  list(TRANSFORM includes REPLACE "^#include <plumbline/([^>]+)>.*" "\\1")
  list(REMOVE_ITEM includes ${PLUMBLINE_PUBLIC_HEADERS} ${reached})
  if(includes)
    message(SEND_ERROR "${source} includes ${includes}, which is not installed")
  endif()
endforeach()
