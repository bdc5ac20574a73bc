// Another configuration for a replay, from two that were made of keys.
#pragma once

#include "fovea/servo/servo_config.hpp"

namespace fovea::flight {

// `recorded`, but with `after`'s value in each field in which `after` differs from `before`. So keys that
// were written in decimal, or scaled since, change nothing but what somebody changed.
servo::ServoConfig WithChanges(const servo::ServoConfig& recorded, const servo::ServoConfig& before,
                               const servo::ServoConfig& after);

}  // namespace fovea::flight
