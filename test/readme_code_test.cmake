# cmake -D README=... -D PREFIX=... -D FLAGS=... -D WORK=... -P readme_code_test.cmake
# Builds and runs the first CMake and the first C++ block under "Embedding".
cmake_minimum_required(VERSION 3.18)
file(READ ${README} text)
string(FIND "${text}" "\n## Embedding" begin)
string(SUBSTRING "${text}" ${begin} -1 text)

function(write_block language file)
  string(FIND "${text}" "```${language}\n" begin)
  if(begin LESS 0)
    message(FATAL_ERROR "there is no ${language} block under \"Embedding\"")
  endif()
  string(SUBSTRING "${text}" ${begin} -1 block)
  string(FIND "${block}" "\n" begin)
  string(FIND "${block}" "\n```" end)
  math(EXPR length "${end} - ${begin}")
  string(SUBSTRING "${block}" ${begin} ${length} block)
  file(WRITE ${file} "${block}\n")
endfunction()

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "failed: ${ARGN}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
write_block(cmake ${WORK}/CMakeLists.txt)
write_block(cpp ${WORK}/main.cc)
run(${CMAKE_COMMAND} -S ${WORK} -B ${WORK}/build -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_CXX_FLAGS=${FLAGS})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/my_robot)
