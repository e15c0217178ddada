# cmake -D ROOT=... -D LIBRARY=<the built library> -D WORK=... -P packages_test.cmake
# cpack makes the package of a library that is built, without the programs, which are not, and
# compiles nothing.
cmake_minimum_required(VERSION 3.18)

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE result
                  OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(result)
    message(FATAL_ERROR "failed: ${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
run(${CMAKE_COMMAND} -S ${ROOT} -B ${WORK} -G "Unix Makefiles" -DCMAKE_BUILD_TYPE=Release
    -DPLUMBLINE_BUILD_TESTS=OFF)
get_filename_component(name ${LIBRARY} NAME)
configure_file(${LIBRARY} ${WORK}/${name} COPYONLY)  # as if built
run(cpack -G DEB)

file(GLOB_RECURSE objects ${WORK}/*.o ${WORK}/*.gch)
if(objects)
  message(SEND_ERROR "cpack compiled ${objects}")
endif()
file(GLOB packages RELATIVE ${WORK} ${WORK}/*.deb)
if(NOT packages MATCHES "^libplumbline-dev_[^;]*[.]deb$")
  message(FATAL_ERROR "cpack made: ${packages}")
endif()
run(dpkg-deb --info ${WORK}/${packages})
file(STRINGS ${ROOT}/CMakeLists.txt version REGEX "^set\\(PLUMBLINE_CERES_VERSION ")
string(REGEX REPLACE ".*VERSION ([0-9.]+)\\).*" "\\1" version "${version}")
if(NOT output MATCHES "Depends: libceres-dev \\(>= ${version}\\), libeigen3-dev")
  message(SEND_ERROR "the package does not depend on Ceres ${version}: ${output}")
endif()
run(dpkg-deb --contents ${WORK}/${packages})
foreach(file lib/${name} plumbline/solvers/solve.h plumblineConfig.cmake plumbline.pc)
  if(NOT output MATCHES "${file}")
    message(SEND_ERROR "the package has no ${file}: ${output}")
  endif()
endforeach()
