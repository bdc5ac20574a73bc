// SPDX-License-Identifier: Apache-2.0
// Detects joints whose encoders hang: the reading stays the same although the joint must have moved.
//
// Three signs show that it must have moved: its measured velocity, the reference that it should follow, and
// the torque. The contact observer's residual (contact.hpp) is the external torque that would explain why a
// joint does not move as the motors drive it. If the residual changes by more than friction may hold while
// the reading stays, the joint has moved, or something firm holds it. Both are reasons to stop.
//
// A joint at rest under an unknown load also has a residual, but a constant one.
//
// A fourth sign needs no motion: most encoders have noise in their last bits. After a joint at rest has
// flickered for a tenth of a second without repeating a reading, readings that repeat to the last bit are
// invalid. This is known before the arm leaves Boot and finds its target.
//
// Noise of the velocity seems to move a resting joint. What the watch integrates must therefore exceed what
// the noise comes to in the same time.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/dynamics.hpp"

namespace fovea::estimate {

struct EncoderWatch {
  struct Joint {
    double residual = 0.0;  // of the observer, in the previous tick [Nm, N]
    double mean = 0.0;      // of the external torque [Nm, N]
    // Since its reading last changed
    std::int32_t ticks = 0;
    double q = 0.0;                 // that reading [rad, m]
    double q_reference = 0.0;       // its reference at that time [rad, m]
    double dq = 0.0;                // its velocity before the unseen acceleration [rad/s, m/s]
    double speed = 0.0;             // gained from that acceleration [rad/s, m/s]
    double way = 0.0;               // moved at that speed [rad, m]
    double travel = 0.0;            // moved at its measured velocity [rad, m]
    std::int32_t unseen_ticks = 0;  // in a row with an unseen acceleration
    // Its noise
    double q_last = 0.0;           // of the state before [rad, m]
    double dq_last = 0.0;          // [rad/s, m/s]
    double change_last = 0.0;      // of dq, in the last state in which it changed [rad/s, m/s]
    std::int32_t flickers = 0;     // at rest: states in which dq reversed its change, less those without
    std::int32_t same_ticks = 0;   // states in a row that repeat the one before to the last bit
    bool is_noisy = false;         // it flickers at rest
    double noise2 = 0.0;           // variance of dq [rad^2/s^2, m^2/s^2]; below 0: its motion hides it
    std::int32_t noise_ticks = 0;  // that the mean `noise2` is over
  };
  bool drove = false;  // the servo drove the arm in the previous tick
  std::array<Joint, hal::kMaxJoints> joints{};
};

// The joints in a tick with a new state, each [num_joints].
struct WatchedJoints {
  const model::VecN& q;   // measured
  const model::VecN& dq;  // measured
  const model::ArmDynamics& dynamics;
  const model::VecN& residual;     // of the contact observer
  const model::VecN& q_reference;  // in the previous tick
  bool drives = true;              // false: residual and reference are invalid
};

// Returns the joint whose encoder hangs, or -1. Real-time: yes.
[[nodiscard]] std::int32_t WatchEncoders(const config::ServoConfig& config, const WatchedJoints& now,
                                         EncoderWatch& watch) noexcept;

}  // namespace fovea::estimate
