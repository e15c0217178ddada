# Usage: cmake -D CHECK=<CheckIncludeDirection.cmake> -D TREE=<scratch folder> -P <this file>
# The check passes a tree that keeps the rules and fails on each way to break one.
cmake_minimum_required(VERSION 3.18)

function(run_check result_variable error_variable)
  execute_process(COMMAND ${CMAKE_COMMAND} -D ROOT=${TREE} -P ${CHECK}
                  RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE error)
  string(REGEX REPLACE "[ \n]+" " " error "${error}")  # CMake wraps its messages.
  set(${result_variable} ${result} PARENT_SCOPE)
  set(${error_variable} "${error}" PARENT_SCOPE)
endfunction()

function(make_good_tree)
  file(REMOVE_RECURSE ${TREE})
  file(WRITE ${TREE}/core/a.h "#include <Eigen/Core>\n")
  file(WRITE ${TREE}/core/a.cc
       "#include \"plumbline/core/a.h\"\n\n#include <nanoflann.hpp>\n#include <vector>\n")
  file(WRITE ${TREE}/factors/b.h "#include <ceres/ceres.h>\n#include \"plumbline/core/a.h\"\n")
  file(WRITE ${TREE}/solvers/interface/c.h "#include \"plumbline/factors/b.h\"\n")
  file(WRITE ${TREE}/solvers/interface/quiet_ceres.cc
       "#include <glog/logging.h>\nceres::Solve(options, problem, summary);\n")
  file(WRITE ${TREE}/solvers/reduced/d.h "#include \"plumbline/solvers/interface/c.h\"\n")
  file(WRITE ${TREE}/solvers/door.h "#include \"plumbline/solvers/reduced/d.h\"\n")
  file(WRITE ${TREE}/apps/d_main.cc
       "#include <gflags/gflags.h>\n#include <iostream>\n#include \"plumbline/solvers/door.h\"\n")
  file(WRITE ${TREE}/test/a_test.cc
       "#include \"plumbline/core/a.h\"\n#include \"plumbline/test/e.h\"\n")
  file(WRITE ${TREE}/apps/slam_toolbox/f.h "#include <plumbline/core/a.h>\n")
  file(WRITE ${TREE}/apps/slam_toolbox/plugin.cc "#include \"f.h\"\n")
endfunction()

function(expect_complaint file text complaint)
  make_good_tree()
  file(WRITE ${TREE}/${file} "${text}")
  run_check(result error)
  string(FIND "${error}" "${file}: ${complaint}" position)
  if(result EQUAL 0 OR position LESS 0)
    message(SEND_ERROR "No complaint '${complaint}' about ${file}, but: ${error}")
  endif()
endfunction()

make_good_tree()
run_check(result error)
if(NOT result EQUAL 0)
  message(SEND_ERROR "A good tree fails: ${error}")
endif()

expect_complaint(core/x.h "#include \"plumbline/factors/b.h\"\n" "core may not include")
expect_complaint(factors/x.cc "  #  include \"plumbline/solvers/c.h\"\n" "factors may not include")
expect_complaint(solvers/full/x.h "#include \"plumbline/apps/d.h\"\n" "solvers may not include")
expect_complaint(apps/io/x.h "#include \"plumbline/test/e.h\"\n" "apps may not include")
expect_complaint(solvers/full/x.h "#include \"plumbline/solvers/reduced/d.h\"\n"
                 "its folder may not include")
expect_complaint(solvers/reduced/x.h "#include \"plumbline/solvers/door.h\"\n"
                 "its folder may not include")
expect_complaint(apps/attic/x.h "#include \"plumbline/apps/io/y.h\"\n" "the folder of")
expect_complaint(core/x.cc "int y;\n#include \"a.h\"\n" "write \"a.h\" as")
expect_complaint(apps/slam_toolbox/x.h "#include \"none.h\"\n" "write \"none.h\" as")
expect_complaint(apps/slam_toolbox/x.h "#include \"plumbline/apps/d_main.h\"\n"
                 "its folder may not include")
expect_complaint(core/x.h "#include <ceres/jet.h>\n" "core may not include <ceres/jet.h>")
expect_complaint(solvers/x.h "#include <nanoflann.hpp>\n" "a public header may not include")
expect_complaint(solvers/x.cc "int x = std::fprintf (stderr, 0);\n" "the library may not print")
expect_complaint(solvers/x.cc "ceres::Solve(options, &problem, &summary);\n"
                 "ceres::Solve prints, call SolveQuietly")
expect_complaint(solvers/x.cc "const ceres::Manifold* x;\n" "Ceres 2.0 has no manifolds")
expect_complaint(solvers/x.h "ceres::LocalParameterization x;\n" "Ceres 2.0 has no manifolds")
foreach(header gflags/gflags.h glog/logging.h iostream fstream)
  foreach(folder core factors solvers)
    expect_complaint(${folder}/x.cc "#include <${header}>\n" "the library may not include <${header}>")
  endforeach()
endforeach()
expect_complaint(core/a.cc "#include <vector>\n#include \"plumbline/core/a.h\"\n"
                 "its first include must be")
expect_complaint(solvers/full/x.h "class A final {\n};\nclass B;\nstruct A : B {\n};\n"
                 "A is defined in solvers/full/x.h as well")
string(REPEAT "\n" 251 long_header)
expect_complaint(apps/x.h "${long_header}" "251 lines")
string(REPEAT "// [;\n" 601 long_source)
expect_complaint(test/x_test.cc "${long_source}" "601 lines")
