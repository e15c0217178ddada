# Uses ccache if it is installed. A project that takes the source
# tree in chooses its own compiler launcher.
find_program(PLUMBLINE_CCACHE ccache DOC "Compiler cache; empty: none")
if(NOT PLUMBLINE_TOP_LEVEL OR NOT PLUMBLINE_CCACHE OR CMAKE_CXX_COMPILER_LAUNCHER)
  return()
endif()
# CCACHE_DEPEND finds the inputs of a compilation in its dependency file and skips the preprocessor.
# The sloppiness and the flags below are needed for precompiled headers, see ccache's manual. There
# is no CCACHE_BASEDIR, which would share results between checkouts: a precompiled header of clang
# names its source by an absolute path, and is no use to another checkout.
set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_DEPEND=1
    CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
    ${PLUMBLINE_CCACHE})
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fpch-preprocess)
else()
  add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
endif()
