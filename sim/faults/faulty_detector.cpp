// SPDX-License-Identifier: Apache-2.0
#include "sim/faults/faulty_detector.hpp"

#include <limits>

#include "sim/faults/chance.hpp"

namespace fovea::sim {

void FaultyDetector::SetFaults(const DetectorFaults& faults) {
  DetectorFaults changed = faults;
  changed.seed = faults_.Get().seed;
  faults_.Set(changed);
}

void FaultyDetector::Put(const hal::FeatureMeasurement& measurement) noexcept {
  const DetectorFaults faults = faults_.Get();
  hal::FeatureMeasurement said = measurement;
  if (said.found && faults.wrong.window.Contains(said.stamp_ns) &&
      Chance(faults.seed, said.sequence) < faults.wrong.share) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(said.dim); ++i) {
      said.s[i] += faults.wrong.shift[i];
    }
  }
  if (said.found && faults.not_a_number.Contains(said.stamp_ns)) {
    said.s[0] = std::numeric_limits<double>::quiet_NaN();
  }
  sink_.Put(said);
}

}  // namespace fovea::sim
