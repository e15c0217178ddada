#include <algorithm>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/apps/saved_maps/cartographer_graph.h"
#include "plumbline/apps/saved_maps/cartographer_state.h"
#include "plumbline/apps/saved_maps/cartographer_stream.h"
#include "plumbline/apps/saved_maps/cartographer_writer.h"
#include "plumbline/test/fuzz/map_graph.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  const std::string content(reinterpret_cast<const char*>(data), size);
  CartographerState state;
  if (!ParseCartographerState("", content, &state).ok()) return 0;
  SlamGraph graph;
  CartographerGraphNotes notes;
  if (!BuildGraph(state, "", &graph, &notes).ok()) return 0;
  // What was read can be written elsewhere, and read again.
  std::vector<double> poses = graph.initial_poses();
  for (double& coordinate : poses) coordinate *= 0.5;
  std::ostringstream written;
  WriteCartographerState(state.content, poses, &written);
  CartographerState again;
  Require(ParseCartographerState("", written.str(), &again).ok());
  Require(again.nodes.size() == state.nodes.size());
  MapGraph(/*seed=*/false, std::move(graph));
  return 0;
}

// There where libFuzzer is.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size)
    __attribute__((weak));

// Most mutations change a message before it is compressed: behind gzip's checksums, none would get
// through.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t max_size, unsigned seed) {
  using namespace plumbline;
  constexpr std::size_t kMaxMessageBytes = 1 << 16;
  std::minstd_rand random(seed);
  std::vector<std::string> messages;
  const std::string content(reinterpret_cast<const char*>(data), size);
  CartographerStream stream("", content);
  while (stream.Next() && stream.message().size() <= kMaxMessageBytes) {
    messages.emplace_back(stream.message());
  }
  if (messages.empty() || random() % 16 == 0) return LLVMFuzzerMutate(data, size, max_size);
  std::string& message = messages[random() % messages.size()];
  std::vector<std::uint8_t> bytes(2 * message.size() + 64);
  std::copy(message.begin(), message.end(), bytes.begin());
  const std::size_t new_size = LLVMFuzzerMutate(bytes.data(), message.size(), bytes.size());
  message.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(new_size));
  std::string mutated(kCartographerMagic);
  for (const std::string& part : messages) mutated += CartographerMessage(part);
  if (mutated.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::copy(mutated.begin(), mutated.end(), data);
  return mutated.size();
}
