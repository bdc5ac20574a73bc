// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/commanded_motion.hpp"

#include <cmath>
#include <numbers>

namespace fovea::sim {
namespace {

// An angle whose rate rises from 0 to `omega` by a smooth step over the first second.
struct SoftTurn {
  double angle = 0.0;         // [rad]
  double rate = 0.0;          // [rad/s]
  double acceleration = 0.0;  // [rad/s^2]
};
SoftTurn TurnAt(double omega, double t) noexcept {
  if (t >= 1.0) {
    return {omega * (t - 0.5), omega, 0.0};
  }
  if (t <= 0.0) {
    return {};
  }
  return {omega * t * t * t * t * (2.5 + t * (-3.0 + t)), omega * t * t * t * (10.0 + t * (-15.0 + 6.0 * t)),
          omega * t * t * (30.0 + t * (-60.0 + 30.0 * t))};
}

}  // namespace

moves::MotionCommand CommandedJoints::At(double t_s) const noexcept {
  moves::MotionCommand command;
  command.kind = moves::MotionKind::kJointSetpoint;
  const double sine = std::sin(omega * t_s);
  const double cosine = std::cos(omega * t_s);
  for (std::size_t i = 0; i < from.size(); ++i) {
    command.q[i] = from[i] + velocity[i] * t_s + amplitude[i] * sine;
    command.dq[i] = velocity[i] + amplitude[i] * omega * cosine;
    command.ddq[i] = -amplitude[i] * omega * omega * sine;
  }
  return command;
}

moves::MotionCommand CommandedWaves::At(double t_s) const noexcept {
  moves::MotionCommand command;
  command.kind = moves::MotionKind::kJointSetpoint;
  const SoftTurn turn = TurnAt(omega, t_s);
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double sine = std::sin(multiple[i] * turn.angle);
    const double cosine = std::cos(multiple[i] * turn.angle);
    const double rate = multiple[i] * turn.rate;
    command.q[i] = from[i] + amplitude[i] * sine;
    command.dq[i] = amplitude[i] * cosine * rate;
    command.ddq[i] = amplitude[i] * (cosine * multiple[i] * turn.acceleration - sine * rate * rate);
  }
  return command;
}

moves::MotionCommand CommandedCircle::At(double t_s) const noexcept {
  moves::MotionCommand command;
  const double t = t_s - lead_s;
  command.kind = t < 0.0 ? moves::MotionKind::kPoseGoal : moves::MotionKind::kPoseSetpoint;
  const auto [angle, rate, acceleration] = TurnAt(2.0 * std::numbers::pi * rate_hz, t);
  const Eigen::Vector3d p = centre + radius * (std::sin(angle) * across + std::cos(angle) * down);
  const Eigen::Vector3d v = radius * rate * (std::cos(angle) * across - std::sin(angle) * down);
  command.p_BE = {p.x(), p.y(), p.z()};
  command.V_BE_B = {v.x(), v.y(), v.z(), 0.0, 0.0, 0.0};
  command.quaternion_BE = {hand.w(), hand.x(), hand.y(), hand.z()};
  return command;
}

moves::MotionCommand CommandedHome::At(double /*t_s*/) const noexcept {
  moves::MotionCommand command;
  command.kind = moves::MotionKind::kHome;
  return command;
}

moves::MotionCommand CommandedMotionSource::At(std::int64_t now_ns) noexcept {
  const double t_s = 1e-9 * static_cast<double>(now_ns);
  return std::visit([t_s](const auto& motion) { return motion.At(t_s); }, motion_);
}

}  // namespace fovea::sim
