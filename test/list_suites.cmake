# Included by ctest: adds an entry for every test suite of the GoogleTest program PROGRAM.
cmake_minimum_required(VERSION 3.18)
if(NOT EXISTS "${PROGRAM}")
  add_test(NOT_BUILT "${PROGRAM}")  # fails, and its name says why
  return()
endif()
execute_process(COMMAND "${PROGRAM}" --gtest_list_tests OUTPUT_VARIABLE suites
                RESULT_VARIABLE result TIMEOUT 60)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${result}")
endif()
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." suites "${suites}")
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "[\n.]" "" suite "${suite}")
  add_test("${suite}" "${PROGRAM}" "--gtest_filter=${suite}.*")
  set_tests_properties("${suite}" PROPERTIES
    ENVIRONMENT "LSAN_OPTIONS=suppressions=${LEAKS_OF_OTHERS}:print_suppressions=0")
  if(suite STREQUAL SlamMpiTest)  # processes that wait for each other do so busily
    set_tests_properties("${suite}" PROPERTIES PROCESSORS 2)
  endif()
  if(suite IN_LIST SLOW_SUITES)
    set_tests_properties("${suite}" PROPERTIES LABELS slow COST 100)
  endif()
endforeach()
