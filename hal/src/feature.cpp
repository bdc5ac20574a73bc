// SPDX-License-Identifier: Apache-2.0
#include "fovea/hal/feature.hpp"

namespace fovea::hal {

void FeatureMailbox::Put(const FeatureMeasurement& measurement) noexcept { box_.Put(measurement); }

bool FeatureMailbox::Take(FeatureMeasurement& measurement) noexcept { return box_.Take(measurement); }

}  // namespace fovea::hal
