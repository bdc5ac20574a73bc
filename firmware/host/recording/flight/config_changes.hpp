// Another configuration for a replay, from two that were made of keys.
#pragma once

#include "firmware/core/config/servo_config.hpp"

namespace fovea::flight {

// `recorded`, but with `after`'s value in each field in which `after` differs from `before`. So keys that
// were written in decimal, or scaled since, change nothing but what somebody changed.
config::ServoConfig WithChanges(const config::ServoConfig& recorded, const config::ServoConfig& before,
                                const config::ServoConfig& after);

}  // namespace fovea::flight
