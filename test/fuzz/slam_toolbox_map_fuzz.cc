#include <string>
#include <utility>

#include "plumbline/apps/saved_maps/karto_classes.h"
#include "plumbline/apps/saved_maps/slam_toolbox_graph.h"
#include "plumbline/apps/saved_maps/slam_toolbox_map.h"
#include "plumbline/apps/saved_maps/slam_toolbox_writer.h"
#include "plumbline/test/apps/saved_maps/posegraph_writer.h"
#include "plumbline/test/fuzz/input_file.h"
#include "plumbline/test/fuzz/map_graph.h"

// x.posegraph or x.data, beside a good one of the other.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  static const InputFile file;
  static const KartoMap good = SmallKartoMap();
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  SlamToolboxMap map;
  if (map.mapper.Read(bytes, KartoClasses(), "karto::Mapper").ok()) {
    Require(map.dataset.Read(DataBytes(good), KartoClasses(), "karto::Dataset").ok());
  } else if (map.dataset.Read(bytes, KartoClasses(), "karto::Dataset").ok()) {
    Require(map.mapper.Read(PosegraphBytes(good), KartoClasses(), "karto::Mapper").ok());
  } else {
    return 0;
  }
  SlamGraph graph;
  int num_restarts = 0;
  if (!BuildGraph(map, &graph, &num_restarts).ok()) return 0;
  Require(graph.num_scans() > 0);
  // What was read can be written with other poses, and read again with these.
  std::vector<double> poses = graph.initial_poses();
  poses[0] = 0.5;
  const std::string path = file.Holding(data, 0) + ".posegraph";
  Require(WriteSlamToolboxMap(path, map, poses).ok());
  SlamToolboxMap again;
  SlamGraph graph_again;
  Require(ReadSlamToolboxMap(path, 0.0, &again).ok());
  for (const std::string& written : SlamToolboxFiles(path)) std::filesystem::remove(written);
  Require(BuildGraph(again, &graph_again, &num_restarts).ok());
  Require(graph_again.initial_poses()[0] == 0.5);
  MapGraph(/*seed=*/false, std::move(graph));
  return 0;
}
