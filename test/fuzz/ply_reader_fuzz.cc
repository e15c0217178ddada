#include <cmath>

#include "plumbline/apps/evaluation/map_sharpness.h"
#include "plumbline/apps/io/ply_reader.h"
#include "plumbline/test/fuzz/input_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace plumbline;
  static const InputFile file;
  std::vector<double> points;
  if (!ReadPointsPly(file.Holding(data, size), &points).ok()) return 0;
  for (const double number : points) Require(std::isfinite(number));
  ThreadPool pool(1);
  Require(MeasureSharpness(points, &pool).num_points == points.size() / 2);
  return 0;
}
