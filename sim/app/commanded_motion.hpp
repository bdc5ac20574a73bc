// A motion of the joints as a scenario commands it, as a source for the servo's loop.
#pragma once

#include <cmath>

#include "fovea/servo/motion_command.hpp"

namespace fovea::sim {

// q(t) = from + velocity t + amplitude sin(omega t) for each joint, t from the run's start.
struct CommandedMotion {
  hal::JointArray from{};       // [num_joints] [rad, m]
  hal::JointArray velocity{};   // [num_joints]
  hal::JointArray amplitude{};  // [num_joints]
  double omega = 1.0;           // [rad/s]

  [[nodiscard]] servo::MotionCommand At(double t_s) const noexcept {
    servo::MotionCommand command;
    command.kind = servo::MotionKind::kJointSetpoint;
    const double sine = std::sin(omega * t_s);
    const double cosine = std::cos(omega * t_s);
    for (std::size_t i = 0; i < from.size(); ++i) {
      command.q[i] = from[i] + velocity[i] * t_s + amplitude[i] * sine;
      command.dq[i] = velocity[i] + amplitude[i] * omega * cosine;
      command.ddq[i] = -amplitude[i] * omega * omega * sine;
    }
    return command;
  }
};

class CommandedMotionSource final : public servo::MotionSource {
 public:
  explicit CommandedMotionSource(const CommandedMotion& motion) : motion_(motion) {}
  servo::MotionCommand At(std::int64_t now_ns) noexcept override {
    return motion_.At(1e-9 * static_cast<double>(now_ns));
  }

 private:
  CommandedMotion motion_;
};

}  // namespace fovea::sim
