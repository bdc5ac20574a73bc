// SPDX-License-Identifier: Apache-2.0
// The largest allowed speed towards a barrier (THEORY B5).
#pragma once

namespace fovea::barriers {

// The fastest speed [m/s or rad/s] from which a stop within `distance` is possible, given the deceleration
// and the reaction time; 0 when the distance is used up. Real-time: yes.
[[nodiscard]] double BarrierSpeed(double distance, double deceleration, double reaction_s) noexcept;

}  // namespace fovea::barriers
