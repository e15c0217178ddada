// A raw log in; a trajectory, a map of every laser return, pictures and numbers out.

#include "plumbline/apps/program/command_line.h"
#include "plumbline/apps/run/slam_program.h"

int main(int argc, char** argv) {
  plumbline::StartProgram(
      "Maps a raw log (CARMEN, or bag of ROS 1 or ROS 2), or refines a pose graph or a saved map: "
      "joint estimation of all poses and all laser returns.\n\n"
      "  plumbline_slam --log=fr079.clf.gz --output_dir=out\n"
      "  plumbline_slam --log=monday.clf,tuesday.bag --output_dir=out\n"
      "  plumbline_slam --info=x.bag\n"
      "  plumbline_slam --log=fr079.clf.gz --output_dir=out --solver=ceres "
      "--ceres=linear_solver_type=iterative_schur",
      argc, argv);
  plumbline::LogRunOptions options;
  const auto check_flags = [&options] {
    options = plumbline::LogRunOptions();
    return plumbline::SlamOptionsFromFlags(&options);
  };
  return plumbline::RunProgram(plumbline::SlamFiles(), check_flags,
                               [&options] { return plumbline::RunSlam(options); });
}
