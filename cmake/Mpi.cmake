# plumbline_mpi: a graph whose scans lie in several processes, on MPI and PETSc. Debian: petsc-dev,
# libopenmpi-dev.
if(PLUMBLINE_WITH_MPI STREQUAL "AUTO")
  find_package(MPI QUIET COMPONENTS CXX)
  find_package(PkgConfig QUIET)
  if(PKG_CONFIG_FOUND)
    pkg_check_modules(PETSC QUIET IMPORTED_TARGET GLOBAL PETSc)
  endif()
  if(NOT MPI_CXX_FOUND OR NOT PETSC_FOUND)
    message(STATUS "Several processes: not built, for petsc-dev or libopenmpi-dev (Debian's names) "
                   "is not installed")
    return()
  endif()
else()
  find_package(MPI REQUIRED COMPONENTS CXX)
  find_package(PkgConfig REQUIRED)
  pkg_check_modules(PETSC REQUIRED IMPORTED_TARGET GLOBAL PETSc)
endif()
message(STATUS "Several processes: built with PETSc ${PETSC_VERSION}")

file(GLOB PLUMBLINE_MPI_SOURCES CONFIGURE_DEPENDS solvers/mpi/*.cc)
add_library(plumbline_mpi STATIC ${PLUMBLINE_MPI_SOURCES})
target_link_libraries(plumbline_mpi PUBLIC plumbline MPI::MPI_CXX PRIVATE PkgConfig::PETSC)
# The deprecated C++ bindings of MPI.
target_compile_definitions(plumbline_mpi PUBLIC OMPI_SKIP_MPICXX MPICH_SKIP_MPICXX)
plumbline_private_options(plumbline_mpi)
