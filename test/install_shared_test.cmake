# cmake -D BUILD_DIR=... -D STATIC_PREFIX=... -D PREFIX=... -D LIBDIR=... -P install_shared_test.cmake
# Copies an installation of the static library, with a shared library in its place: what a build with
# BUILD_SHARED_LIBS=ON installs.
file(REMOVE_RECURSE ${PREFIX})
file(COPY ${STATIC_PREFIX}/ DESTINATION ${PREFIX})
file(GLOB static ${PREFIX}/${LIBDIR}/libplumbline.* ${PREFIX}/${LIBDIR}/cmake/plumbline/plumblineTargets*)
file(REMOVE ${static})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD_DIR} --component shared_test
                        --prefix ${PREFIX} RESULT_VARIABLE result)
if(result)
  message(FATAL_ERROR "installing failed: ${result}")
endif()
if(EXISTS ${PREFIX}/${LIBDIR}/libplumbline.a OR NOT EXISTS ${PREFIX}/${LIBDIR}/libplumbline.so)
  message(FATAL_ERROR "${PREFIX} does not hold the shared library in place of the static one")
endif()
