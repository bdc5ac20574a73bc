// SPDX-License-Identifier: Apache-2.0
// Sizes and plain arrays that every part of the seam shares.
#pragma once

#include <array>
#include <cstdint>

namespace fovea::hal {

inline constexpr int kMaxJoints = 8;      // most joints of an arm
inline constexpr int kMaxFeatureDim = 8;  // most entries of a visual feature vector s

// One value per joint, base to tip; entries at and past num_joints are zero.
// Units: rad, rad/s, Nm for a revolute joint; m, m/s, N for a prismatic one.
using JointArray = std::array<double, kMaxJoints>;

inline constexpr std::int64_t kNsPerSecond = 1'000'000'000;
inline constexpr std::int64_t kNsPerMs = 1'000'000;
inline constexpr std::int64_t kTickPeriodNs = kNsPerMs;  // the servo's period: 1 kHz

constexpr double ToSeconds(std::int64_t duration_ns) noexcept {
  return static_cast<double>(duration_ns) * 1e-9;
}

inline constexpr double kTickPeriodS = ToSeconds(kTickPeriodNs);

}  // namespace fovea::hal
