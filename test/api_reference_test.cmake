# cmake -D DOXYGEN=... -D DOXYFILE=... -D WORK=... -P api_reference_test.cmake
cmake_minimum_required(VERSION 3.18)

# Builds the reference with additional settings, which win over those of the Doxyfile.
function(build_reference settings result)
  file(WRITE ${WORK}/Doxyfile "@INCLUDE = ${DOXYFILE}\nOUTPUT_DIRECTORY = ${WORK}\n${settings}")
  execute_process(COMMAND ${DOXYGEN} ${WORK}/Doxyfile RESULT_VARIABLE code ERROR_VARIABLE errors)
  set(errors "${errors}" PARENT_SCOPE)
  set(${result} ${code} PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
build_reference("" result)
if(result)
  message(FATAL_ERROR "doxygen warns: ${errors}")
endif()
file(READ ${WORK}/html/tutorial.html tutorial)
if(NOT tutorial MATCHES "AddRelativePose" OR NOT tutorial MATCHES "class=\"fragment\"")
  message(FATAL_ERROR "the tutorial has lost its code")
endif()

file(WRITE ${WORK}/undocumented.h
     "/// A struct.\nstruct Documented {\n  int undocumented;\n};\n")
build_reference("INPUT += ${WORK}/undocumented.h\n" result)
if(NOT result OR NOT errors MATCHES "undocumented")
  message(FATAL_ERROR "an undocumented symbol went unnoticed: ${errors}")
endif()
