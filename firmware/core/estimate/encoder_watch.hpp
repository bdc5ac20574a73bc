// Joints whose encoders hang: the reading stays the same although the joint must have moved.
//
// Three things say that it must have: the velocity that is measured with it, the reference that it should
// follow, and the torque. The contact observer's residual (contact.hpp) is the torque from outside that would
// explain why a joint does not move as its motor, and the other joints, make it. What changes in it while the
// reading stays, beyond what friction may hold, has moved the joint, or else something firm holds it, which
// is as good a reason to stop.
//
// A joint that stands still under a load that nobody knows has a residual, but one that does not change.
//
// A fourth thing needs no motion: most encoders have noise in their last bits. Where a joint at rest has been
// seen to flicker for a tenth of a second without ever repeating itself, readings that repeat to the last bit
// are none. That is known before the arm leaves Boot and finds its target.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/dynamics.hpp"

namespace fovea::estimate {

struct EncoderWatch {
  struct Joint {
    double residual = 0.0;  // of the observer, in the tick before [Nm, N]
    double mean = 0.0;      // of what pushes it [Nm, N]
    // Since its reading last changed
    std::int32_t ticks = 0;
    double q = 0.0;            // that reading [rad, m]
    double q_reference = 0.0;  // where the joint should have been then [rad, m]
    double dq = 0.0;           // its velocity when that torque began [rad/s, m/s]
    double speed = 0.0;        // that the torque has given it [rad/s, m/s]
    double way = 0.0;          // and how far it went [rad, m]
    double travel = 0.0;       // how far it went by its measured velocity [rad, m]
    // Its noise
    double q_last = 0.0;          // of the state before [rad, m]
    double dq_last = 0.0;         // [rad/s, m/s]
    double change_last = 0.0;     // of dq, in the last state in which it changed [rad/s, m/s]
    std::int32_t flickers = 0;    // at rest, states in which dq turned round, less those in which it did not
    std::int32_t same_ticks = 0;  // states in a row that repeat the one before to the last bit
    bool is_noisy = false;        // it is one that flickers
  };
  bool drove = false;  // in the tick before
  std::array<Joint, hal::kMaxJoints> joints{};
};

// What a tick with a new state knows of the joints, each [num_joints].
struct WatchedJoints {
  const model::VecN& q;   // measured
  const model::VecN& dq;  // measured
  const model::ArmDynamics& dynamics;
  const model::VecN& residual;     // of the contact observer
  const model::VecN& q_reference;  // in the tick before
  bool drives = true;              // false: there is neither residual nor reference
};

// Returns the joint whose encoder hangs, or -1. Real-time: yes.
[[nodiscard]] std::int32_t WatchEncoders(const config::ServoConfig& config, const WatchedJoints& now,
                                         EncoderWatch& watch) noexcept;

}  // namespace fovea::estimate
