# Installation such that find_package(plumbline) gives plumbline::plumbline, and pkg-config knows
# plumbline; Debian packages; `uninstall`.
include(CMakePackageConfigHelpers)

set(PLUMBLINE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/plumbline)
configure_package_config_file(cmake/plumblineConfig.cmake.in
  ${PROJECT_BINARY_DIR}/plumblineConfig.cmake INSTALL_DESTINATION ${PLUMBLINE_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/plumblineConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)

# What links to the static library links to its dependencies, too.
set(PLUMBLINE_PC_OWN "-L\${libdir} -lplumbline")
set(PLUMBLINE_PC_OTHERS "-lceres -lglog -pthread")
if(BUILD_SHARED_LIBS)
  set(PLUMBLINE_PC_LIBS "${PLUMBLINE_PC_OWN}")
else()
  set(PLUMBLINE_PC_LIBS "${PLUMBLINE_PC_OWN} ${PLUMBLINE_PC_OTHERS}")
endif()
set(PLUMBLINE_PC_DIR ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH PLUMBLINE_PC_TO_PREFIX /prefix/${PLUMBLINE_PC_DIR} /prefix)
configure_file(cmake/plumbline.pc.in ${PROJECT_BINARY_DIR}/plumbline.pc @ONLY)

install(TARGETS plumbline EXPORT plumblineTargets COMPONENT library)
include(cmake/PublicHeaders.cmake)
foreach(header IN LISTS PLUMBLINE_PUBLIC_HEADERS PLUMBLINE_EXTENSION_HEADERS)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/plumbline/${folder}
          COMPONENT library)
endforeach()
install(EXPORT plumblineTargets NAMESPACE plumbline:: DESTINATION ${PLUMBLINE_PACKAGE_DIR}
        COMPONENT library)
install(FILES ${PROJECT_BINARY_DIR}/plumblineConfig.cmake
              ${PROJECT_BINARY_DIR}/plumblineConfigVersion.cmake
        DESTINATION ${PLUMBLINE_PACKAGE_DIR} COMPONENT library)
install(FILES ${PROJECT_BINARY_DIR}/plumbline.pc DESTINATION ${PLUMBLINE_PC_DIR}
        COMPONENT library)
# Where Debian looks for it: by the names of the packages below.
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libplumbline-dev COMPONENT library
        RENAME copyright)
if(PLUMBLINE_BUILD_APPS)
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/plumbline COMPONENT programs
          RENAME copyright)
endif()

if(NOT PLUMBLINE_TOP_LEVEL)
  return()
endif()

add_custom_target(uninstall COMMAND ${CMAKE_COMMAND} -D BUILD_DIR=${PROJECT_BINARY_DIR}
                                    -P ${PROJECT_SOURCE_DIR}/cmake/Uninstall.cmake)

# cpack -G DEB: libplumbline-dev, and plumbline with the programs, if they are built. It packs what
# is there and builds nothing.
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/cmake/PackWhatIsBuilt.cmake)
set(CPACK_PLUMBLINE_PROGRAM ${PROJECT_BINARY_DIR}/bin/plumbline_slam)
set(CPACK_PLUMBLINE_IO ${PROJECT_BINARY_DIR}/libplumbline_io.a)
set(CPACK_PACKAGE_NAME plumbline)
set(CPACK_PACKAGE_VENDOR "Plumbline")
set(CPACK_PACKAGE_CONTACT "The Plumbline developers <plumbline@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL library)
if(PLUMBLINE_BUILD_APPS)
  list(APPEND CPACK_COMPONENTS_ALL io programs)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libplumbline-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS
    "libceres-dev (>= ${PLUMBLINE_CERES_VERSION}), libeigen3-dev (>= 3.4)")
set(CPACK_DEBIAN_IO_PACKAGE_NAME libplumbline-io-dev)
set(CPACK_DEBIAN_IO_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_IO_PACKAGE_DEPENDS
    "libplumbline-dev (= ${PROJECT_VERSION}), zlib1g-dev, libbz2-dev, libsqlite3-dev, liblz4-dev, libzstd-dev, libyaml-cpp-dev, pkg-config")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME plumbline)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
if(BUILD_SHARED_LIBS)
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR})
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "libplumbline-dev (= ${PROJECT_VERSION})")
endif()
include(CPack)
