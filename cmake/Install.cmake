# Installation such that find_package(plumbline) gives plumbline::plumbline.
include(CMakePackageConfigHelpers)

set(PLUMBLINE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/plumbline)
configure_package_config_file(cmake/plumblineConfig.cmake.in
  ${PROJECT_BINARY_DIR}/plumblineConfig.cmake INSTALL_DESTINATION ${PLUMBLINE_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/plumblineConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)

install(TARGETS plumbline EXPORT plumblineTargets COMPONENT library)
install(DIRECTORY core factors solvers DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/plumbline
        COMPONENT library FILES_MATCHING PATTERN "*.h")
install(EXPORT plumblineTargets NAMESPACE plumbline:: DESTINATION ${PLUMBLINE_PACKAGE_DIR}
        COMPONENT library)
install(FILES ${PROJECT_BINARY_DIR}/plumblineConfig.cmake
              ${PROJECT_BINARY_DIR}/plumblineConfigVersion.cmake
        DESTINATION ${PLUMBLINE_PACKAGE_DIR} COMPONENT library)
