// plumbline_slam in several processes, each with some of the scans.

#include "plumbline/apps/mpi/mpi_program.h"
#include "plumbline/apps/mpi/refused_flags.h"
#include "plumbline/apps/program/stop_signal.h"
#include "plumbline/apps/run/slam_program.h"
#include "plumbline/solvers/mpi/petsc_pose_solver.h"

int main(int argc, char** argv) {
  plumbline::MpiProgram program(
      "plumbline_slam in several processes that mpirun starts, on one machine or on several with a "
      "common file system: each has the scans of a part of the map.\n\n"
      "  mpirun -n 4 plumbline_slam_mpi --log=fr079.clf.gz --output_dir=out",
      &argc, &argv);
  plumbline::LogRunOptions options;
  const auto check_flags = [&] {
    options = plumbline::LogRunOptions();
    options.peers = program.peers();
    const plumbline::Status usable = plumbline::SlamOptionsFromFlags(&options);
    return usable.ok() ? plumbline::CheckGoesWithPeers(options) : usable;
  };
  return program.Run(plumbline::SlamFiles(), check_flags, [&] {
    if (program.peers() != nullptr) {
      options.mapping.solver.reduced.linear_solver =
          plumbline::MakePetscPoseSolver(*program.peers());
      plumbline::EndOnEveryStopSignal();  // PETSc has handled signals
    }
    return plumbline::RunSlam(options);
  });
}
