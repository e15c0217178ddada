#ifndef PLUMBLINE_APPS_SIMULATION_NOISE_SOURCE_H_
#define PLUMBLINE_APPS_SIMULATION_NOISE_SOURCE_H_

#include <cmath>
#include <cstdint>
#include <random>

#include "plumbline/core/angle.h"

namespace plumbline {

/// Random numbers that are the same with every standard library: the standard fixes its engines and
/// std::seed_seq, but not its distributions.
class NoiseSource {
 public:
  /// Sources of the same seed and different streams are independent.
  NoiseSource(std::uint64_t seed, std::uint32_t stream) {
    std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                           stream};
    engine_.seed(sequence);
  }

  /// Uniform on [0, 1), with the 53 bits that a double resolves.
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  /// Uniform on [low, high).
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  /// Standard normal (Box & Muller 1958).
  double Gaussian() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    return radius * std::cos(2.0 * kPi * Uniform());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SIMULATION_NOISE_SOURCE_H_
