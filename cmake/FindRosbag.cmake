# find_package(Rosbag) gives Rosbag::rosbag, which reads and writes bags of ROS 1 with scans, odometry
# and transforms: librosbag_storage and the headers of the messages, of Debian or of a sourced ROS.
# Their own CMake packages are not asked: those run Python modules of ROS, and fail where the first
# Python in the path is not the system's.
set(ROSBAG_REQUIRED)
set(ROSBAG_INCLUDES)
set(ROSBAG_LIBRARIES)

# Debian keeps the headers of some packages in folders of their own. Those after OPTIONAL are not
# part of every ROS.
set(optional FALSE)
foreach(header rosbag/bag.h ros/time.h sensor_msgs/LaserScan.h nav_msgs/Odometry.h
        tf2_msgs/TFMessage.h boost/shared_ptr.hpp pluginlib/class_loader.hpp
        class_loader/class_loader.hpp OPTIONAL rcpputils/shared_library.hpp
        rcutils/logging_macros.h ament_index_cpp/get_resource.hpp)
  if(header STREQUAL "OPTIONAL")
    set(optional TRUE)
    continue()
  endif()
  get_filename_component(package ${header} DIRECTORY)
  find_path(ROSBAG_${package}_INCLUDE ${header} PATH_SUFFIXES ${package})
  mark_as_advanced(ROSBAG_${package}_INCLUDE)
  if(NOT optional)
    list(APPEND ROSBAG_REQUIRED ROSBAG_${package}_INCLUDE)
  endif()
  if(ROSBAG_${package}_INCLUDE)
    list(APPEND ROSBAG_INCLUDES ${ROSBAG_${package}_INCLUDE})
  endif()
endforeach()
foreach(library rosbag_storage roscpp_serialization rostime cpp_common console_bridge)
  find_library(ROSBAG_${library}_LIBRARY ${library})
  mark_as_advanced(ROSBAG_${library}_LIBRARY)
  list(APPEND ROSBAG_REQUIRED ROSBAG_${library}_LIBRARY)
  list(APPEND ROSBAG_LIBRARIES ${ROSBAG_${library}_LIBRARY})
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Rosbag REQUIRED_VARS ${ROSBAG_REQUIRED})
if(Rosbag_FOUND AND NOT TARGET Rosbag::rosbag)
  list(REMOVE_DUPLICATES ROSBAG_INCLUDES)
  add_library(Rosbag::rosbag INTERFACE IMPORTED GLOBAL)
  set_target_properties(Rosbag::rosbag PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${ROSBAG_INCLUDES}"
    INTERFACE_LINK_LIBRARIES "${ROSBAG_LIBRARIES}")
endif()
