// Loads the plug-in by its name, has it map two nodes, and says how many were corrected.
#include <karto_sdk/Mapper.h>

#include <cstdio>
#include <memory>
#include <pluginlib/class_loader.hpp>

#ifdef STAND_IN_FOR_HUMBLE
using Host = rclcpp::Node;
#else
using Host = rclcpp_lifecycle::LifecycleNode;
#endif

int main() {
  pluginlib::ClassLoader<karto::ScanSolver> loader("slam_toolbox", "karto::ScanSolver");
  const auto solver = loader.createSharedInstance("plumbline::JointScanSolver");
  solver->Configure(std::make_shared<Host>());
  karto::LocalizedRangeScan scans[2] = {{karto::Name("laser"), {1.0, 1.0}},
                                        {karto::Name("laser"), {1.0, 1.0}}};
  for (int id = 0; id < 2; ++id) {
    scans[id].SetUniqueId(id);
    karto::Vertex<karto::LocalizedRangeScan> vertex(&scans[id]);
    solver->AddNode(&vertex);
  }
  solver->Compute();
  std::printf("%zu corrections\n", solver->GetCorrections().size());
  return solver->GetCorrections().size() == 2 ? 0 : 1;
}
