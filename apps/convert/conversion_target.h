#ifndef PLUMBLINE_APPS_CONVERT_CONVERSION_TARGET_H_
#define PLUMBLINE_APPS_CONVERT_CONVERSION_TARGET_H_

#include <string>
#include <vector>

#include "plumbline/core/slam_graph.h"
#include "plumbline/core/status.h"

namespace plumbline {

/// What a conversion can write.
enum class ConversionFormat {
  kTum,     ///< .tum: poses and their times
  kG2o,     ///< .g2o: poses, edges, scans
  kToro,    ///< .toro, .graph: the same
  kPly,     ///< .ply: measured ends of the beams
  kPcd,     ///< .pcd: the same
  kRosMap,  ///< .pgm, .yaml: occupancy grid, always both files
};
const char* ToString(ConversionFormat format);
bool FromString(const std::string& name, ConversionFormat* format);

/// A file to write; of a ROS map either of its two, or their common stem.
struct ConversionTarget {
  std::string path;
  ConversionFormat format = ConversionFormat::kTum;

  /// Path of a ROS map without its extension.
  std::string MapStem() const;
  /// The files that will be there.
  std::vector<std::string> Files() const;
  /// Whether it shows scans and nothing else.
  bool NeedsReturns() const;
};

/// Takes a list of paths, separated by commas, apart. The extension tells the format, or `format`
/// (empty: none) for a list of one. InvalidArgument on an empty path, an extension or name that
/// stands for no format, and a format for more than one path.
Status ParseConversionTargets(const std::string& paths, const std::string& format,
                              std::vector<ConversionTarget>* targets);

/// What of a graph the format has no place for: "3 poses, 2 edges"; empty if it holds all. A first
/// pose that is fixed does not count: all readers take it so.
std::string LeftOut(ConversionFormat format, const SlamGraph& graph);

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_CONVERT_CONVERSION_TARGET_H_
