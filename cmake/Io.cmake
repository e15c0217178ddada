# plumbline::io: logs and saved maps in files, for programs and hosts. It is static, and a component
# of its own, since it needs the libraries of the file formats.
find_package(ZLIB REQUIRED)
find_package(BZip2 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(PLUMBLINE_BAGS REQUIRED IMPORTED_TARGET GLOBAL sqlite3 liblz4 libzstd yaml-cpp)

file(GLOB IO_SOURCES CONFIGURE_DEPENDS apps/io/*.cc apps/bags/*.cc apps/saved_maps/*.cc
     apps/readers/*.cc)
add_library(plumbline_io STATIC ${IO_SOURCES})
add_library(plumbline::io ALIAS plumbline_io)
# Position-independent so that plugins and the Python module can take it in.
set_target_properties(plumbline_io PROPERTIES EXPORT_NAME io POSITION_INDEPENDENT_CODE ON
                                              CXX_EXTENSIONS OFF)
target_link_libraries(plumbline_io PUBLIC plumbline
                                   PRIVATE ZLIB::ZLIB BZip2::BZip2 PkgConfig::PLUMBLINE_BAGS)
plumbline_private_options(plumbline_io)
plumbline_precompile_eigen(plumbline_io)
plumbline_unity(plumbline_io)

install(TARGETS plumbline_io EXPORT plumblineIoTargets COMPONENT io)
foreach(header IN LISTS PLUMBLINE_IO_HEADERS)
  get_filename_component(folder ${header} DIRECTORY)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/plumbline/${folder} COMPONENT io)
endforeach()
install(EXPORT plumblineIoTargets NAMESPACE plumbline:: DESTINATION ${PLUMBLINE_PACKAGE_DIR}
        COMPONENT io)
