#include "plumbline/apps/report/stage.h"

#include <cmath>
#include <iomanip>
#include <sstream>

#include "plumbline/apps/report/units.h"
#include "plumbline/core/angle.h"

namespace plumbline {

Stage MeasureStage(const std::string& name, const SlamGraph& graph, const MapState& state,
                   const Truth* truth, ThreadPool* pool) {
  Stage stage;
  stage.name = name;
  stage.quality = MeasureMapQuality(graph, MapPoints(graph, state), MapQualityOptions(), pool);
  if (truth != nullptr) stage.error = CompareWithTruth(graph, state, *truth);
  return stage;
}

std::string StageTable(const std::vector<Stage>& stages) {
  const bool with_truth = !stages.empty() && stages.front().error.has_value();
  std::ostringstream table;
  table << std::left << std::setw(26) << "" << std::right << std::setw(15) << "wall thickness"
        << std::setw(13) << "map entropy";
  if (with_truth) {
    table << std::setw(13) << "pose error" << std::setw(14) << "heading error" << std::setw(12)
          << "map error";
  }
  table << '\n' << std::fixed;
  for (const Stage& stage : stages) {
    table << std::left << std::setw(26) << stage.name << std::right;
    if (stage.quality.num_samples > 0) {
      table << std::setprecision(1) << std::setw(12) << kMmPerM * stage.quality.wall_thickness_m
            << " mm" << std::setprecision(3) << std::setw(13) << stage.quality.mean_map_entropy;
    } else {
      table << std::setw(15) << "-" << std::setw(13) << "-";
    }
    if (stage.error) {
      table << std::setprecision(1) << std::setw(10) << kMmPerM * stage.error->mean_pose_error_m
            << " mm" << std::setprecision(3) << std::setw(10)
            << RadToDeg(stage.error->mean_pose_error_rad) << " deg";
      if (std::isnan(stage.error->mean_point_error_m)) {
        table << std::setw(12) << "-";
      } else {
        table << std::setprecision(1) << std::setw(9) << kMmPerM * stage.error->mean_point_error_m
              << " mm";
      }
    }
    table << '\n';
  }
  return table.str();
}

}  // namespace plumbline
