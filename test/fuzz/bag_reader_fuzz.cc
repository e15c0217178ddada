#include "plumbline/apps/bags/bag_reader.h"
#include "plumbline/apps/io/ros_recording.h"
#include "plumbline/test/fuzz/input_file.h"
#include "plumbline/test/fuzz/map_graph.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  static const InputFile file;
  RosRecording recording;
  if (!ReadBag(file.Holding(data, size), BagReadOptions(), &recording).ok()) return 0;
  RosGraphNotes notes;
  SlamGraph graph;
  if (!BuildGraph(recording, RosGraphOptions(), 0, &notes, &graph).ok()) return 0;
  Require(graph.num_scans() > 0);
  if (graph.num_returns() > 0) MapGraph(/*seed=*/true, std::move(graph));
  return 0;
}
