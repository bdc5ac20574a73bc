// SPDX-License-Identifier: Apache-2.0
// What is assumed of a target when it is first seen.
#pragma once

namespace fovea::estimate {

inline constexpr double kStartSpeedSigma = 0.3;         // how fast it may be [m/s]
inline constexpr double kStartAccelerationSigma = 0.5;  // and how hard it may accelerate [m/s^2]

}  // namespace fovea::estimate
