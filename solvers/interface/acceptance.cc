#include "plumbline/solvers/interface/acceptance.h"

#include <algorithm>
#include <sstream>

namespace plumbline {

double AcceptanceTest::LargestHeldOutError() const {
  const double by_chance = (1.0 + kRounding) * seed_held_out_error + 2.0 * held_out_noise;
  return with_other_constraints ? std::max(by_chance, 2.0 * seed_held_out_error) : by_chance;
}

std::string AcceptanceTest::Text() const {
  std::ostringstream text;
  text << "energy over the landmarks of seed and result " << seed_energy << " -> " << final_energy
       << ", " << num_held_out << " held-out returns: mean squared distance " << seed_held_out_error
       << " -> " << final_held_out_error << " sigmas^2";
  if (!LowersEnergy()) text << "; the energy is not lower";
  if (!KeepsHeldOutError()) {
    text << "; the held-out returns fit worse, beyond the " << LargestHeldOutError() << " allowed";
  }
  if (num_worse_stretches > 0) {
    text << "; " << num_worse_stretches << " stretches of the drive fit clearly worse";
  }
  return text.str();
}

}  // namespace plumbline
