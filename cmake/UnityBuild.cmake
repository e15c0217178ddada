# Most of the time of a compilation goes into the headers of libraries. A unity build compiles the
# sources of one folder or several as one, which reads them once. That is quicker where everything is
# built once. While developing it takes longer, and hides what a source forgets to include.
option(PLUMBLINE_UNITY_BUILD "Compile the sources of a folder as one: quicker from scratch" OFF)

# Folders of one target that are compiled as one unit; one that is not listed is a unit of its own.
# Names in anonymous namespaces must be unique across a unit.
set(PLUMBLINE_UNITS
  "core|factors"
  "solvers|solvers/interface|solvers/acceptance|solvers/terms|solvers/association|solvers/landmarks"
  "solvers/front_end|solvers/loop_closure|solvers/hypotheses|solvers/seeding"
  "solvers/full|solvers/reduced"
  "apps/io|apps/readers"
  "apps/simulation|apps/program"
  "apps/figures|apps/convert")

function(plumbline_unity target)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${source})
    get_filename_component(folder ${folder} DIRECTORY)
    set(unit ${folder})
    foreach(candidate IN LISTS PLUMBLINE_UNITS)
      if(folder MATCHES "^(${candidate})$")
        set(unit ${candidate})
      endif()
    endforeach()
    string(MAKE_C_IDENTIFIER ${unit} unit)
    set_property(SOURCE ${source} PROPERTY UNITY_GROUP ${unit})
  endforeach()
  set_property(TARGET ${target} PROPERTY UNITY_BUILD_MODE GROUP)
  if(PLUMBLINE_UNITY_BUILD)
    set_property(TARGET ${target} PROPERTY UNITY_BUILD ON)
    # gcc takes what a unit includes for headers, where anonymous namespaces would be a mistake.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# Sets `result` to sources of a unity build, one for each folder of the tests `sources`. Tests are
# nothing but an anonymous namespace each, whose names are those of all tests; so it gets a name.
function(plumbline_join_tests sources result)
  set(units)
  foreach(source IN LISTS sources)
    file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR} ${source})
    get_filename_component(folder ${name} DIRECTORY)
    string(MAKE_C_IDENTIFIER ${folder} unit)
    string(MAKE_C_IDENTIFIER ${name} namespace)
    file(READ ${source} text)
    string(REPLACE "\nnamespace {\n" "\nnamespace ${namespace} {\n" text "${text}")
    string(APPEND ${unit}_text "#line 1 \"${source}\"\n${text}")
    list(APPEND units ${unit})
  endforeach()
  # A source that changes is joined again.
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${sources})
  list(REMOVE_DUPLICATES units)
  set(joined)
  foreach(unit IN LISTS units)
    set(path ${CMAKE_CURRENT_BINARY_DIR}/joined/${unit}.cc)
    file(WRITE ${path}.new "${${unit}_text}")
    configure_file(${path}.new ${path} COPYONLY)
    list(APPEND joined ${path})
  endforeach()
  set(${result} ${joined} PARENT_SCOPE)
endfunction()
