# Usage: cmake -D ROOT=<source tree> -P CheckIncludeDirection.cmake
# Fails if an #include runs against core <- factors <- solvers <- apps <- test or against the order of
# the folders inside solvers and apps, if a library folder includes what only programs may, if x.cc
# does not include its own x.h first (which proves that x.h compiles alone), if a file is too long, or
# if two headers define a class of the same name: the linker would mix their inline functions.
cmake_minimum_required(VERSION 3.18)

set(FOLDERS core factors solvers apps test)  # Each may include itself and those before it.
set(LIBRARY_FOLDERS core factors solvers)
# The folders inside these two, likewise in order. Their own files come last: the doors of the
# library, and the main files of the programs.
set(ROOMS_solvers interface pose_graph front_end loop_closure hypotheses seeding sessions online association terms
    landmarks acceptance full reduced incremental mpi .)
set(ROOMS_apps io bags saved_maps readers simulation program evaluation pictures figures report run
    convert mpi slam_toolbox live dds ros2 benchmark python .)
# A package of its own, which is built against the installed library: its files include each other
# by their names alone, and of ours what is installed.
set(PACKAGE apps/slam_toolbox)
# The only file of the library that may include glog, and call ceres::Solve: it keeps Ceres quiet.
set(QUIET_CERES solvers/interface/quiet_ceres.cc)
# The only file of core that looks into a cost function, that of a host's own factor.
set(COST_FUNCTIONS core/factor_check.cc)
set(MAX_LINES_h 250)
set(MAX_LINES_cc 600)

function(complain message)
  message(SEND_ERROR "${message}")
endfunction()

# Sets `rank` to where the room of a path inside `folder` stands; -1 if nobody knows the room.
function(find_room folder path rank)
  get_filename_component(room ${path} DIRECTORY)
  string(REGEX REPLACE "^${folder}/?" "" room "${room}")
  if(room STREQUAL "")
    set(room .)
  endif()
  list(FIND ROOMS_${folder} ${room} found)
  set(${rank} ${found} PARENT_SCOPE)
endfunction()

# An example includes the library only, and nothing includes it.
function(check_rooms file folder include)
  string(REGEX REPLACE "^\"plumbline/([^\"]+)\"" "\\1" target ${include})
  find_room(${folder} ${file} rank)
  find_room(${folder} ${target} target_rank)
  if(rank LESS 0 OR target_rank LESS 0)
    complain("${file}: the folder of ${file} or of ${include} is not in ROOMS_${folder}")
  elseif(target_rank GREATER rank)
    complain("${file}: its folder may not include ${include}")
  endif()
endfunction()

function(check_include file folder include)
  if(include MATCHES "^\"plumbline/([^/]+)/")
    set(target ${CMAKE_MATCH_1})
    list(FIND FOLDERS ${folder} rank)
    list(FIND FOLDERS ${target} target_rank)
    if(target_rank LESS 0 OR target_rank GREATER rank)
      complain("${file}: ${folder} may not include ${include}")
    elseif(DEFINED ROOMS_${folder} AND target STREQUAL folder)
      check_rooms(${file} ${folder} ${include})
    endif()
  elseif(include MATCHES "^\"")
    string(REPLACE "\"" "" own "${include}")
    if(file MATCHES "^${PACKAGE}/" AND EXISTS ${ROOT}/${PACKAGE}/${own})
      return()
    endif()
    complain("${file}: write ${include} as \"plumbline/<folder>/<file>\"")
  elseif(folder STREQUAL "core" AND include MATCHES "[/.]"
         AND NOT include MATCHES "^<(Eigen/|nanoflann\\.hpp>|xmmintrin\\.h>)"
         AND NOT (file STREQUAL COST_FUNCTIONS AND include STREQUAL "<ceres/cost_function.h>"))
    complain("${file}: core may not include ${include}, only the standard library and Eigen")
  endif()
  if(folder IN_LIST LIBRARY_FOLDERS AND include MATCHES "^<(gflags/|glog/|iostream|fstream)"
     AND NOT (file STREQUAL QUIET_CERES AND include STREQUAL "<glog/logging.h>"))
    complain("${file}: the library may not include ${include}, it neither prints nor reads files")
  elseif(folder IN_LIST LIBRARY_FOLDERS AND include MATCHES "nanoflann" AND file MATCHES "h$")
    complain("${file}: a public header may not include ${include}, users need not have it")
  endif()
endfunction()

# The classes of the namespace, which are those not indented.
function(check_classes file text)
  string(REGEX MATCHALL "\n(class|struct|enum class) [A-Za-z0-9_]+[^;{<\n]*{" definitions "\n${text}")
  foreach(definition IN LISTS definitions)
    string(REGEX REPLACE "^\n(class|struct|enum class) ([A-Za-z0-9_]+).*" "\\2" name "${definition}")
    get_property(other GLOBAL PROPERTY header_of_${name})
    if(other)
      complain("${file}: ${name} is defined in ${other} as well")
    endif()
    set_property(GLOBAL PROPERTY header_of_${name} ${file})
  endforeach()
endfunction()

function(check_file file)
  string(REGEX MATCH "^[^/]+" folder ${file})
  file(READ ${ROOT}/${file} text)
  if(folder IN_LIST LIBRARY_FOLDERS AND text MATCHES "[^a-z_](f?printf|f?puts) *\\(")
    complain("${file}: the library may not print")
  endif()
  if(folder IN_LIST LIBRARY_FOLDERS AND NOT file STREQUAL QUIET_CERES
     AND text MATCHES "ceres::Solve *\\(")
    complain("${file}: ceres::Solve prints, call SolveQuietly")
  endif()
  if(folder IN_LIST LIBRARY_FOLDERS AND text MATCHES "Manifold\\*|LocalParameterization|SetManifold")
    complain("${file}: Ceres 2.0 has no manifolds, and 2.2 nothing else")
  endif()

  if(file MATCHES "h$")
    check_classes(${file} "${text}")
  endif()

  string(REGEX MATCHALL "\n" newlines "${text}")
  list(LENGTH newlines lines)
  string(REGEX MATCH "[^.]+$" extension ${file})
  if(lines GREATER MAX_LINES_${extension})
    complain("${file}: ${lines} lines, more than ${MAX_LINES_${extension}}")
  endif()

  string(REGEX MATCHALL "\n[ \t]*#[ \t]*include[ \t]*[<\"][^>\"\n]+[>\"]" includes "\n${text}")
  list(TRANSFORM includes REPLACE "^[^<\"]+" "")
  foreach(include IN LISTS includes)
    check_include(${file} ${folder} ${include})
  endforeach()

  string(REGEX REPLACE "cc$" "h" header ${file})
  if(extension STREQUAL "cc" AND EXISTS ${ROOT}/${header})
    list(GET includes 0 first)
    if(NOT first STREQUAL "\"plumbline/${header}\"")
      complain("${file}: its first include must be \"plumbline/${header}\"")
    endif()
  endif()
endfunction()

foreach(folder IN LISTS FOLDERS)
  file(GLOB_RECURSE files RELATIVE ${ROOT} ${ROOT}/${folder}/*.h ${ROOT}/${folder}/*.cc)
  foreach(file IN LISTS files)
    check_file(${file})
  endforeach()
endforeach()
