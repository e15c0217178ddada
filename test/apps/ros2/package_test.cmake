# cmake -D PACKAGE=<apps/ros2> -D TESTS=<test/apps/ros2> -D TARGETS=<exported by the build>
#       -D ROOT=<source tree> -D GENERATOR=... -D FLAGS=<for the compiler>
#       -D TEST_COMPILER=<of tests; may be empty> -D PYTHON=<the system's, for ament> -D WORK=...
#       -P package_test.cmake
# Builds and installs the package as colcon does, with ament as it is and a stand-in of rclcpp, on
# the libraries of this build; loads the component and drives its node. Then configures the package
# on the source tree, as users build it.
cmake_minimum_required(VERSION 3.18)

set(prefix ${WORK}/prefix)
set(stand_in ${TESTS}/stand_in)
file(REMOVE_RECURSE ${WORK})

set(driver_compiler)
if(TEST_COMPILER)
  set(driver_compiler -DCMAKE_CXX_COMPILER=${TEST_COMPILER})
endif()

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(result)
    message(FATAL_ERROR "failed: ${ARGN}\n${output}")
  endif()
endfunction()

# Writes a package without libraries: the headers of the stand-in, and a header per message.
function(write_package name messages)
  foreach(message ${messages})
    file(WRITE ${prefix}/include/${name}/${message}.hpp "#include <messages.hpp>\n")
  endforeach()
  file(WRITE ${prefix}/share/${name}/cmake/${name}Config.cmake
       "set(${name}_INCLUDE_DIRS ${stand_in} ${prefix}/include)\n")
  file(WRITE ${prefix}/share/ament_index/resource_index/packages/${name} "")
endfunction()

write_package(rclcpp "")
write_package(rclcpp_lifecycle "")
write_package(rclcpp_components "")
file(APPEND ${prefix}/share/rclcpp_components/cmake/rclcpp_componentsConfig.cmake [[
function(rclcpp_components_register_node target)
  cmake_parse_arguments(ARG "" "PLUGIN;EXECUTABLE" "" ${ARGN})
  if(NOT TARGET ${target} OR NOT ARG_PLUGIN OR NOT ARG_EXECUTABLE OR ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "rclcpp_components_register_node: ${ARGN}")
  endif()
  ament_index_register_resource(
    rclcpp_components CONTENT "${ARG_PLUGIN};lib/${CMAKE_SHARED_LIBRARY_PREFIX}${target}.so\n")
endfunction()
]])
write_package(diagnostic_msgs "msg/diagnostic_array;srv/add_diagnostics")
write_package(geometry_msgs "msg/pose_with_covariance_stamped")
write_package(nav_msgs "msg/occupancy_grid;msg/odometry;msg/path")
write_package(sensor_msgs "msg/laser_scan")
write_package(std_srvs "srv/set_bool;srv/trigger")
write_package(tf2_msgs "msg/tf_message")

set(configure ${CMAKE_COMMAND} -E env CMAKE_PREFIX_PATH=${prefix}
    ${CMAKE_COMMAND} -G ${GENERATOR} -DPython3_EXECUTABLE=${PYTHON})
set(on_build -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= -DCMAKE_CXX_FLAGS=${FLAGS}
    -DPLUMBLINE_TREE=${TESTS}/built_tree -DPLUMBLINE_TARGETS=${TARGETS})
run(${configure} -S ${PACKAGE} -B ${WORK}/build ${on_build} -DCMAKE_INSTALL_PREFIX=${prefix}
    -DCMAKE_SHARED_LINKER_FLAGS=-Wl,--no-undefined -DCMAKE_UNITY_BUILD=ON)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${CMAKE_COMMAND} --install ${WORK}/build)
foreach(file launch/plumbline.launch.py config/plumbline.yaml package.xml)
  if(NOT EXISTS ${prefix}/share/plumbline_ros/${file})
    message(FATAL_ERROR "${file} is not installed")
  endif()
endforeach()
run(${PYTHON} -m py_compile ${prefix}/share/plumbline_ros/launch/plumbline.launch.py)
run(${configure} -S ${TESTS}/driver -B ${WORK}/driver ${on_build} ${driver_compiler})
run(${CMAKE_COMMAND} --build ${WORK}/driver)
run(${CMAKE_COMMAND} -E env AMENT_PREFIX_PATH=${prefix} LD_LIBRARY_PATH=${prefix}/lib
    PLUMBLINE_ROS_CONFIG=${prefix}/share/plumbline_ros/config/plumbline.yaml
    ${WORK}/driver/driver)

# The package finds the source tree through a link in a workspace.
file(CREATE_LINK ${PACKAGE} ${WORK}/plumbline_ros SYMBOLIC)
run(${configure} -S ${WORK}/plumbline_ros -B ${WORK}/of_source_tree)
file(STRINGS ${WORK}/of_source_tree/CMakeCache.txt tree REGEX "^PLUMBLINE_TREE:")
if(NOT tree STREQUAL "PLUMBLINE_TREE:PATH=${ROOT}")
  message(FATAL_ERROR "the package takes another source tree: ${tree}")
endif()
