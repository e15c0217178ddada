# cmake -D BUILD_DIR=... -D PREFIX=... -D UNINSTALL=... -P uninstall_test.cmake
# What was installed to the prefix from the build folder goes without a trace.
file(GLOB_RECURSE before ${PREFIX}/*)
list(LENGTH before num_before)
if(num_before LESS 20)
  message(FATAL_ERROR "only ${num_before} files were installed to ${PREFIX}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} -D BUILD_DIR=${BUILD_DIR} -P ${UNINSTALL}
                RESULT_VARIABLE result OUTPUT_QUIET)
if(result)
  message(FATAL_ERROR "uninstalling failed: ${result}")
endif()
file(GLOB_RECURSE after LIST_DIRECTORIES true ${PREFIX}/*)
list(FILTER after INCLUDE REGEX "plumbline")
if(after)
  message(FATAL_ERROR "left behind: ${after}")
endif()
