#ifndef PLUMBLINE_APPS_IO_BEAM_DIRECTION_H_
#define PLUMBLINE_APPS_IO_BEAM_DIRECTION_H_

#include <string>

namespace plumbline {

/// The side from which the beams of a laser are counted.
enum class BeamDirection {
  kStated,      ///< as the log says
  kReversed,    ///< from the other end of the fan; the points of a cloud as kUpsideDown
  kUpsideDown,  ///< mirrored about the laser's forward axis, as of one that hangs upside down
};

/// False if there is no such name: "stated", "reversed", "upside_down".
inline bool FromString(const std::string& name, BeamDirection* direction) {
  if (name == "stated") {
    *direction = BeamDirection::kStated;
  } else if (name == "reversed") {
    *direction = BeamDirection::kReversed;
  } else if (name == "upside_down") {
    *direction = BeamDirection::kUpsideDown;
  } else {
    return false;
  }
  return true;
}

/// Turns the bearings [rad] of the first beam and from a beam to the next of a laser.
inline void TurnBeams(BeamDirection direction, int num_beams, double* first_rad, double* step_rad) {
  if (direction == BeamDirection::kStated) return;
  *first_rad = direction == BeamDirection::kReversed ? *first_rad + (num_beams - 1) * *step_rad
                                                     : -*first_rad;
  *step_rad = -*step_rad;
}

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_IO_BEAM_DIRECTION_H_
