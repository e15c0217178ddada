#include "plumbline/apps/pictures/overlay_pictures.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "plumbline/apps/pictures/palette.h"

namespace plumbline {
namespace {

constexpr Rgb kMagenta{0.80, 0.00, 0.55};
constexpr double kRingSpacingM = 0.5;

// "6 refused: free space conflict".
std::string RefusedLabel(std::size_t count, ClosureOutcome outcome) {
  std::string reason = ToString(outcome);
  std::replace(reason.begin(), reason.end(), '_', ' ');
  return std::to_string(count) + " refused: " + reason;
}

// One point of each square of kRingSpacingM.
std::vector<Eigen::Vector2d> ThinnedPlaces(const std::vector<SpaceConflict>& places) {
  std::vector<Eigen::Vector2d> thinned;
  std::set<std::pair<double, double>> squares;
  for (const SpaceConflict& place : places) {
    const Eigen::Vector2d square = (place.world_point / kRingSpacingM).array().floor();
    if (squares.emplace(square.x(), square.y()).second) thinned.push_back(place.world_point);
  }
  return thinned;
}

}  // namespace

Status ShowClosures(const MapState& state, const std::vector<LoopClosureRecord>& records,
                    MapPictureOptions* picture) {
  std::map<ClosureOutcome, MapOverlay> by_outcome;
  by_outcome[ClosureOutcome::kAccepted];  // has its line in the legend also if there is none
  for (const LoopClosureRecord& record : records) {
    for (const int pose : {record.from_pose, record.to_pose}) {
      if (pose < 0 || pose >= state.num_poses()) {
        return Status::InvalidArgument("closure picture: no pose " + std::to_string(pose));
      }
      by_outcome[record.outcome].points.push_back(state.WorldFromRobot(pose).translation());
    }
  }
  picture->title = "Loop closures";
  picture->overlays.clear();
  for (auto& [outcome, overlay] : by_outcome) {
    const bool accepted = outcome == ClosureOutcome::kAccepted;
    const std::size_t count = overlay.points.size() / 2;
    overlay.style = accepted ? OverlayStyle::kLinks : OverlayStyle::kDashedLinks;
    overlay.color = accepted ? kBlue : kOrange;
    overlay.label =
        accepted ? std::to_string(count) + " loop closures" : RefusedLabel(count, outcome);
    picture->overlays.push_back(std::move(overlay));
  }
  return Status::Ok();
}

MapPictureOptions ShowConflicts(const MapConsistency& consistency) {
  MapOverlay places;
  places.style = OverlayStyle::kRings;
  places.color = kMagenta;
  places.points = ThinnedPlaces(consistency.places);
  places.label = std::to_string(places.points.size()) + " places that another scan looked through";
  const bool wrong = consistency.IsContradictory();
  char title[80];
  std::snprintf(title, sizeof(title), "%s (ratio %.1f)",
                wrong ? "The map contradicts itself" : "Free-space conflicts", consistency.Ratio());
  MapPictureOptions picture;
  picture.title = title;
  picture.overlays = {std::move(places)};
  return picture;
}

}  // namespace plumbline
