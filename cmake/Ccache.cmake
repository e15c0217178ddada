# ccache, where it is installed: a source that was compiled before is not compiled again, in whatever
# build folder of this tree. Never in the build of those who take the tree in.
find_program(PLUMBLINE_CCACHE ccache DOC "Compiler cache; empty: none")
if(NOT PLUMBLINE_TOP_LEVEL OR NOT PLUMBLINE_CCACHE OR CMAKE_CXX_COMPILER_LAUNCHER)
  return()
endif()
# What a compilation has read is known from its list of dependencies, which spares preprocessing.
# Precompiled headers need the rest: see "Precompiled headers" in ccache's manual.
set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_DEPEND=1 CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}
    CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
    ${PLUMBLINE_CCACHE})
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fpch-preprocess)
else()
  add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
endif()
