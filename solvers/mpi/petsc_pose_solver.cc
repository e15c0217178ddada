#include "plumbline/solvers/mpi/petsc_pose_solver.h"

#include <petscksp.h>

#include <stdexcept>
#include <string>

namespace plumbline {
namespace {

void Check(PetscErrorCode code) {
  if (code == 0) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw std::runtime_error(std::string("PETSc: ") + (text != nullptr ? text : "unknown error"));
}

// What the callbacks of PETSc need.
struct Problem {
  const PoseSystem& system;
  const LineObservations& observations;
  const PosePreconditioner& preconditioner;
  ThreadPool* pool;
};

// Calls apply(input, &output) on vectors of this process' rows.
template <typename ApplyTo>
PetscErrorCode WithRows(Vec input, Vec output, const ApplyTo& apply) {
  PetscFunctionBegin;
  PetscInt size = 0;
  const PetscScalar* from = nullptr;
  PetscScalar* to = nullptr;
  PetscCall(VecGetLocalSize(input, &size));
  PetscCall(VecGetArrayRead(input, &from));
  const Eigen::VectorXd v = Eigen::Map<const Eigen::VectorXd>(from, size);
  PetscCall(VecRestoreArrayRead(input, &from));
  Eigen::VectorXd result;
  try {
    apply(v, &result);
  } catch (const std::exception&) {
    PetscFunctionReturn(PETSC_ERR_LIB);
  }
  PetscCall(VecGetArrayWrite(output, &to));
  Eigen::Map<Eigen::VectorXd>(to, size) = result;
  PetscCall(VecRestoreArrayWrite(output, &to));
  PetscFunctionReturn(0);
}

PetscErrorCode ApplySystem(Mat matrix, Vec input, Vec output) {
  Problem* problem = nullptr;
  PetscCall(MatShellGetContext(matrix, &problem));
  return WithRows(input, output, [problem](const Eigen::VectorXd& v, Eigen::VectorXd* result) {
    problem->system.Apply(problem->observations, v, problem->pool, result);
  });
}

PetscErrorCode ApplyPreconditioner(PC preconditioner, Vec input, Vec output) {
  Problem* problem = nullptr;
  PetscCall(PCShellGetContext(preconditioner, &problem));
  return WithRows(input, output, [problem](const Eigen::VectorXd& v, Eigen::VectorXd* result) {
    problem->preconditioner.Apply(v, result);
  });
}

// The objects of one solve.
class KspSolve {
 public:
  KspSolve(MPI_Comm communicator, Problem* problem) {
    const auto size = static_cast<PetscInt>(problem->system.gradient.size());
    Check(VecCreateMPI(communicator, size, PETSC_DETERMINE, &right_hand_side_));
    Check(VecDuplicate(right_hand_side_, &x_));
    Check(MatCreateShell(communicator, size, size, PETSC_DETERMINE, PETSC_DETERMINE, problem,
                         &matrix_));
    Check(MatShellSetOperation(matrix_, MATOP_MULT, reinterpret_cast<void (*)()>(ApplySystem)));
    Check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
    Check(KSPCreate(communicator, &solver_));
    Check(KSPSetOptionsPrefix(solver_, "plumbline_"));
    Check(KSPSetOperators(solver_, matrix_, matrix_));
    Check(KSPSetType(solver_, KSPCG));
    Check(KSPSetNormType(solver_, KSP_NORM_NATURAL));
    PC preconditioner = nullptr;
    Check(KSPGetPC(solver_, &preconditioner));
    Check(PCSetType(preconditioner, PCSHELL));
    Check(PCShellSetContext(preconditioner, problem));
    Check(PCShellSetApply(preconditioner, ApplyPreconditioner));
    Check(KSPSetFromOptions(solver_));
  }
  ~KspSolve() {
    KSPDestroy(&solver_);
    MatDestroy(&matrix_);
    VecDestroy(&x_);
    VecDestroy(&right_hand_side_);
  }
  KspSolve(const KspSolve&) = delete;
  KspSolve& operator=(const KspSolve&) = delete;

  PoseSystemResult Run(const Eigen::VectorXd& right_hand_side, double relative_tolerance,
                       int max_iterations, Eigen::VectorXd* x) {
    PetscScalar* to = nullptr;
    Check(VecGetArrayWrite(right_hand_side_, &to));
    Eigen::Map<Eigen::VectorXd>(to, right_hand_side.size()) = right_hand_side;
    Check(VecRestoreArrayWrite(right_hand_side_, &to));
    Check(KSPSetTolerances(solver_, relative_tolerance, 0.0, PETSC_DEFAULT, max_iterations));
    Check(KSPSolve(solver_, right_hand_side_, x_));
    const PetscScalar* from = nullptr;
    Check(VecGetArrayRead(x_, &from));
    *x = Eigen::Map<const Eigen::VectorXd>(from, right_hand_side.size());
    Check(VecRestoreArrayRead(x_, &from));
    PetscInt iterations = 0;
    KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
    Check(KSPGetIterationNumber(solver_, &iterations));
    Check(KSPGetConvergedReason(solver_, &reason));
    return {static_cast<int>(iterations), reason > 0};
  }

 private:
  Vec right_hand_side_ = nullptr, x_ = nullptr;
  Mat matrix_ = nullptr;
  KSP solver_ = nullptr;
};

class PetscPoseSolver final : public PoseSystemSolver {
 public:
  explicit PetscPoseSolver(const MpiPeers& peers) : peers_(peers) {
    PetscBool is_up = PETSC_FALSE;
    Check(PetscInitialized(&is_up));
    if (is_up) return;
    Check(PetscInitializeNoArguments());
    // Errors come back as codes, without a report on standard error, and signals are the program's.
    Check(PetscPushErrorHandler(PetscReturnErrorHandler, nullptr));
    Check(PetscPopSignalHandler());
  }

  PoseSystemResult Solve(const PoseSystem& system, const LineObservations& observations,
                         const PosePreconditioner& preconditioner,
                         const Eigen::VectorXd& right_hand_side, double relative_tolerance,
                         int max_iterations, ThreadPool* pool, Eigen::VectorXd* x) const override {
    Problem problem{system, observations, preconditioner, pool};
    return KspSolve(peers_.communicator(), &problem)
        .Run(right_hand_side, relative_tolerance, max_iterations, x);
  }

 private:
  const MpiPeers& peers_;
};

}  // namespace

std::shared_ptr<const PoseSystemSolver> MakePetscPoseSolver(const MpiPeers& peers) {
  return std::make_shared<PetscPoseSolver>(peers);
}

}  // namespace plumbline
