# One ctest entry per test suite, named after it: a process per test would spend a tenth of the test
# time on starting processes. ctest lists the suites when it starts, so new tests need no new
# configuration. A failing entry prints the whole suite, with the names of the failed tests.

# plumbline_add_suites(PROGRAM): adds the suites of PROGRAM. The ones in SLOW_SUITES are labelled
# `slow` and start first, so that none of them runs alone at the end.
function(plumbline_add_suites program)
  set(suites ${CMAKE_CURRENT_BINARY_DIR}/${program}_suites.cmake)
  file(GENERATE OUTPUT ${suites} CONTENT "\
set(PROGRAM [==[$<TARGET_FILE:${program}>]==])
set(SLOW_SUITES [==[${SLOW_SUITES}]==])
set(LEAKS_OF_OTHERS [==[${CMAKE_CURRENT_SOURCE_DIR}/leak_suppressions.txt]==])
include([==[${CMAKE_CURRENT_SOURCE_DIR}/list_suites.cmake]==])
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${suites})
endfunction()

# plumbline_set_test_compiler(PROGRAM): compiles it with PLUMBLINE_TEST_COMPILER, if that is set.
function(plumbline_set_test_compiler program)
  if(NOT PLUMBLINE_TEST_COMPILER)
    target_compile_options(${program} PRIVATE $<$<CONFIG:Release>:-O1>)
    return()
  endif()
  set_target_properties(${program} PROPERTIES CXX_COMPILER_LAUNCHER
    "${CMAKE_CURRENT_SOURCE_DIR}/compile_with.sh;${CMAKE_CXX_COMPILER_LAUNCHER};${PLUMBLINE_TEST_COMPILER};--")
  target_compile_options(${program} PRIVATE -O0 -fpch-instantiate-templates
                         "SHELL:-Xclang -fno-pch-timestamp")
  # The linker keeps the first copy of an inline function: the library's, which is optimised.
  target_link_options(${program} PRIVATE -Wl,--whole-archive $<TARGET_FILE:plumbline>
                      $<TARGET_FILE:plumbline_logs> -Wl,--no-whole-archive)
endfunction()
