# cmake -D BUILD_DIR=... -D PREFIX=... -P install_test.cmake
# Installs the library and its readers to a prefix that holds files of others.
file(REMOVE_RECURSE ${PREFIX})
file(WRITE ${PREFIX}/include/other/plumbline.h "// not ours\n")
foreach(component library io)
  execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD_DIR} --component ${component}
                          --prefix ${PREFIX} RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "installing ${component} failed: ${result}")
  endif()
endforeach()
