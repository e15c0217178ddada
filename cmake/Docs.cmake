# `docs`: the API reference, in docs/html of the build folder. A warning is an error.
find_package(Doxygen QUIET)
if(NOT DOXYGEN_FOUND)
  return()
endif()
include(cmake/PublicHeaders.cmake)
set(PLUMBLINE_DOCS_DIR ${PROJECT_BINARY_DIR}/docs)
set(PLUMBLINE_DOCS_INPUT cmake/api_main_page.md apps/examples/tutorial.md
                         ${PLUMBLINE_PUBLIC_HEADERS} ${PLUMBLINE_IO_HEADERS}
                         ${PLUMBLINE_EXTENSION_HEADERS})
list(TRANSFORM PLUMBLINE_DOCS_INPUT REPLACE "(.+)" "\"${PROJECT_SOURCE_DIR}/\\1\"")
list(JOIN PLUMBLINE_DOCS_INPUT " " PLUMBLINE_DOCS_INPUT)
configure_file(cmake/Doxyfile.in ${PROJECT_BINARY_DIR}/Doxyfile @ONLY)
file(MAKE_DIRECTORY ${PLUMBLINE_DOCS_DIR})
add_custom_target(docs COMMAND Doxygen::doxygen ${PROJECT_BINARY_DIR}/Doxyfile)
