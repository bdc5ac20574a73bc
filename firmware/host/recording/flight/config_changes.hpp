// SPDX-License-Identifier: Apache-2.0
// Makes a changed configuration for a replay from two configurations that were made from keys.
#pragma once

#include "firmware/core/config/servo_config.hpp"

namespace fovea::flight {

// `recorded`, but with `after`'s value in each field in which `after` differs from `before`. So a key's
// rounding to decimal, or its scaling, changes no field whose key did not change.
config::ServoConfig WithChanges(const config::ServoConfig& recorded, const config::ServoConfig& before,
                                const config::ServoConfig& after);

}  // namespace fovea::flight
