#ifndef PLUMBLINE_SOLVERS_INTERFACE_ASSOCIATION_OPTIONS_H_
#define PLUMBLINE_SOLVERS_INTERFACE_ASSOCIATION_OPTIONS_H_

#include <string>

#include "plumbline/core/options_check.h"

namespace plumbline {

/// Which returns share a surface.
struct AssociationOptions {
  /// A line of single points needs those of more than one pose: the points of one tie it to nothing
  /// but its own noise.
  bool several_poses = true;
  /// Side [m] of the largest cell that may be one landmark, or 32 standard deviations of a return
  /// off its surface if that is more; cells are split down to an eighth. From a millimetre to 100
  /// m, less and more than any wall.
  double landmark_size_m = 0.8;

  /// False if a field is out of range; *error, if not null, then names it, its value and its bound.
  bool Check(std::string* error) const {
    PLUMBLINE_CHECK_OPTION_WITHIN(landmark_size_m, 1e-3, 100.0);
    return true;
  }
};

}  // namespace plumbline

#endif  // PLUMBLINE_SOLVERS_INTERFACE_ASSOCIATION_OPTIONS_H_
