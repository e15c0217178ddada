#ifndef PLUMBLINE_SOLVERS_MPI_PETSC_POSE_SOLVER_H_
#define PLUMBLINE_SOLVERS_MPI_PETSC_POSE_SOLVER_H_

#include <memory>

#include "plumbline/solvers/mpi/mpi_peers.h"
#include "plumbline/solvers/reduced/pose_system_solver.h"

namespace plumbline {

/// Solves pose systems by PETSc's KSP: conjugate gradients, with the system applied and never
/// formed, and our two-level preconditioner. PETSc's own options (the environment variable
/// PETSC_OPTIONS, names that begin with -plumbline_ksp_) change the method, as
/// -plumbline_ksp_type pipecg, which waits for other processes once an iteration instead of twice.
///
/// Starts PETSc, which goes on until the program ends. peers: of the graphs to be solved; has to
/// outlive the solver. Throws std::runtime_error if PETSc fails.
std::shared_ptr<const PoseSystemSolver> MakePetscPoseSolver(const MpiPeers& peers);

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_MPI_PETSC_POSE_SOLVER_H_
