#include "plumbline/apps/benchmark/published_figures.h"

#include <zlib.h>

#include <string_view>

#include "plumbline/apps/io/text_reader.h"

namespace plumbline {
namespace {

constexpr char kKuemmerle[] = "Kuemmerle et al. 2009";
constexpr char kHess[] = "Hess et al. 2016";
constexpr char kTipaldi[] = "Tipaldi et al. 2010";

// The two relations files of the Freiburg SLAM benchmark; checksums as FindPublishedFigures takes
// them.
std::vector<PublishedFigure> FiguresOf(unsigned long checksum) {
  switch (checksum) {
    case 0x954aa060:  // fr079
      return {{"scan matching", kKuemmerle, {0.258, 0.427}, {}},
              {"particle filter", kKuemmerle, {0.061, 0.044}, {}},
              {"graph mapping", kKuemmerle, {0.056, 0.042}, MeanAndStd{0.6, 0.6}},
              {"Graph FLIRT", kTipaldi, {0.06, 0.09}, MeanAndStd{0.8, 1.1}},
              {"Cartographer", kHess, {0.0452, 0.0354}, MeanAndStd{0.538, 0.718}}};
    case 0x686a310a:  // intel
      return {{"scan matching", kKuemmerle, {0.220, 0.296}, {}},
              {"particle filter", kKuemmerle, {0.070, 0.083}, {}},
              {"graph mapping", kKuemmerle, {0.031, 0.026}, MeanAndStd{1.3, 4.7}},
              {"Graph FLIRT", kTipaldi, {0.02, 0.02}, MeanAndStd{0.3, 0.3}},
              {"Cartographer", kHess, {0.0229, 0.0239}, MeanAndStd{0.453, 1.335}}};
    default:
      return {};
  }
}

}  // namespace

Status FindPublishedFigures(const std::string& relations_path,
                            std::vector<PublishedFigure>* figures) {
  TextReader reader;
  PLUMBLINE_RETURN_IF_ERROR(reader.Open(relations_path));
  unsigned long checksum = crc32(0, nullptr, 0);
  const auto add = [&checksum](const char* text, std::size_t size) {
    checksum = crc32(checksum, reinterpret_cast<const Bytef*>(text), static_cast<uInt>(size));
  };
  std::string_view line;
  while (reader.NextLine(&line)) {
    add(line.data(), line.size());
    add("\n", 1);
  }
  PLUMBLINE_RETURN_IF_ERROR(reader.status());
  *figures = FiguresOf(checksum);
  return Status::Ok();
}

}  // namespace plumbline
