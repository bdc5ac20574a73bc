// SPDX-License-Identifier: Apache-2.0
#include "sim/faults/faulty_detector.hpp"

#include <limits>

#include "sim/faults/chance.hpp"

namespace fovea::sim {

void FaultyDetector::Put(const hal::FeatureMeasurement& measurement) noexcept {
  hal::FeatureMeasurement said = measurement;
  if (said.found && faults_.wrong.window.Contains(said.stamp_ns) &&
      Chance(faults_.seed, said.sequence) < faults_.wrong.share) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(said.dim); ++i) {
      said.s[i] += faults_.wrong.shift[i];
    }
  }
  if (said.found && faults_.not_a_number.Contains(said.stamp_ns)) {
    said.s[0] = std::numeric_limits<double>::quiet_NaN();
  }
  sink_.Put(said);
}

}  // namespace fovea::sim
