# cmake -D PACKAGE=<apps/slam_toolbox> -D STAND_IN=<karto and ROS> -D LOADER=<loader/>
#       -D PREFIX=<installed library> -D FLAGS=<for the compiler> -D PYTHON=<the system's, for ament>
#       -D WORK=... -P package_test.cmake
# Builds and installs the package as colcon does, with ament and pluginlib as they are and a stand-in
# of slam_toolbox and rclcpp, and loads the plug-in by its name; for each distribution of ROS.
cmake_minimum_required(VERSION 3.18)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(result)
    message(FATAL_ERROR "failed: ${ARGN}\n${output}")
  endif()
endfunction()

# A package that has nothing but these headers.
function(write_package prefix name definitions)
  file(WRITE ${prefix}/share/${name}/cmake/${name}Config.cmake
       "set(${name}_INCLUDE_DIRS ${STAND_IN})\nset(${name}_DEFINITIONS ${definitions})\n")
  file(WRITE ${prefix}/share/ament_index/resource_index/packages/${name} "")
endfunction()

foreach(distribution humble jazzy)
  set(work ${WORK}/${distribution})
  file(REMOVE_RECURSE ${work})
  string(TOUPPER STAND_IN_FOR_${distribution} definition)
  foreach(name rclcpp rclcpp_lifecycle)
    write_package(${work}/prefix ${name} "")
  endforeach()
  write_package(${work}/prefix slam_toolbox -D${definition})
  set(configure ${CMAKE_COMMAND} -E env CMAKE_PREFIX_PATH=${PREFIX}:${work}/prefix
      ${CMAKE_COMMAND} -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS=${FLAGS}
      -DPython3_EXECUTABLE=${PYTHON})
  run(${configure} -S ${PACKAGE} -B ${work}/build
      -DCMAKE_INSTALL_PREFIX=${work}/prefix -DCMAKE_SHARED_LINKER_FLAGS=-Wl,--no-undefined)
  run(${CMAKE_COMMAND} --build ${work}/build)
  run(${CMAKE_COMMAND} --install ${work}/build)
  run(${configure} -S ${LOADER} -B ${work}/loader)
  run(${CMAKE_COMMAND} --build ${work}/loader)
  run(${CMAKE_COMMAND} -E env AMENT_PREFIX_PATH=${work}/prefix
      LD_LIBRARY_PATH=${work}/prefix/lib ${work}/loader/loader)
endforeach()
