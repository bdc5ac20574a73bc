// SPDX-License-Identifier: Apache-2.0
// When pictures really arrive, and how wrong the stamps are that follow from a believed latency.
#pragma once

#include <algorithm>
#include <cstdint>

#include "sim/faults/chance.hpp"

namespace fovea::sim {

// The servo's computer stamps a picture at its arrival, less the believed latency. A picture that arrives
// later than believed therefore seems newer than it is. Pictures arrive in their order. The clock of the
// stamps may run at another rate than the robot's; they agree at time 0.
struct TrueStamps {
  std::int64_t late_ns = 0;  // true latency minus the believed one
  double jitter_ns = 0.0;    // standard deviation of each picture's latency
  double drift = 0.0;        // rate of the camera's clock minus 1
  std::uint64_t seed = 1;

  // How much later than by the true mean latency frame `sequence` arrives; within three standard deviations.
  [[nodiscard]] std::int64_t JitterNs(std::uint64_t sequence) const {
    if (jitter_ns == 0.0) {
      return 0;
    }
    constexpr double kMostSigmas = 3.0;
    const double normal = std::clamp(NormalChance(seed, 2 * sequence), -kMostSigmas, kMostSigmas);
    return static_cast<std::int64_t>(jitter_ns * normal);
  }
  // How much the camera's clock is ahead at `stamp_ns`.
  [[nodiscard]] std::int64_t DriftNs(std::int64_t stamp_ns) const {
    return static_cast<std::int64_t>(drift * static_cast<double>(stamp_ns));
  }
  // Error of the stamp of a picture that was exposed at `stamp_ns` and arrived `by_jitter_ns` later than by
  // the mean latency.
  [[nodiscard]] std::int64_t ErrorNs(std::int64_t by_jitter_ns, std::int64_t stamp_ns) const {
    return late_ns + by_jitter_ns + DriftNs(stamp_ns);
  }
};

}  // namespace fovea::sim
