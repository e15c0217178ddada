#include "plumbline/apps/io/carmen_log.h"
#include "plumbline/apps/io/log_to_graph.h"
#include "plumbline/test/fuzz/input_file.h"
#include "plumbline/test/fuzz/map_graph.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  static const InputFile file;
  CarmenLog log;
  if (!ReadCarmenLog(file.Holding(data, size), CarmenReadOptions(), &log).ok()) return 0;
  Require(!log.scans.empty());
  SlamGraph graph;
  if (!BuildGraph(log, 0, &graph).ok() || graph.num_returns() == 0) return 0;
  MapGraph(/*seed=*/true, std::move(graph));
  return 0;
}
