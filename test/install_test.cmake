# cmake -D BUILD_DIR=... -D PREFIX=... -P install_test.cmake
# Installs the library to a prefix that holds files of others.
file(REMOVE_RECURSE ${PREFIX})
file(WRITE ${PREFIX}/include/other/plumbline.h "// not ours\n")
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD_DIR} --component library
                        --prefix ${PREFIX} RESULT_VARIABLE result)
if(result)
  message(FATAL_ERROR "installing failed: ${result}")
endif()
