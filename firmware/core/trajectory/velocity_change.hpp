// SPDX-License-Identifier: Apache-2.0
// Changes one axis from any velocity and acceleration to a given velocity, in the shortest time that its
// acceleration and jerk limits allow: jerk to a peak of acceleration, hold the peak, release it.
//
// An axis is anything with one coordinate: a joint [rad, rad/s, ...] or a direction [m, m/s, ...]. The method
// is the double integrator's time optimum with its acceleration as a bounded state (Biagiotti and Melchiorri,
// Trajectory Planning for Automatic Machines and Robots, 2008).
#pragma once

#include <array>

namespace fovea::trajectory {

struct AxisState {
  double x = 0.0;  // position [m or rad]
  double v = 0.0;  // velocity [1/s of it]
  double a = 0.0;  // acceleration [1/s^2 of it]
};

// Bounds of the absolute values, all greater than zero.
struct AxisLimits {
  double v_max = 0.0;
  double a_max = 0.0;
  double j_max = 0.0;
};

struct JerkPhase {
  double duration_s = 0.0;
  double jerk = 0.0;
};

// `state` after `t` seconds of constant `jerk`; a negative `t` goes back. Real-time: yes.
[[nodiscard]] inline AxisState After(const AxisState& state, double jerk, double t) noexcept {
  return {state.x + t * (state.v + t * (0.5 * state.a + t * jerk / 6.0)),
          state.v + t * (state.a + 0.5 * t * jerk), state.a + t * jerk};
}

// The velocity of the axis after its acceleration has gone to zero as fast as the jerk allows.
[[nodiscard]] inline double SettledVelocity(double v, double a, double j_max) noexcept {
  return v + a * (a < 0.0 ? -a : a) / (2.0 * j_max);
}

struct VelocityChange {
  // kReturn brings an acceleration beyond its limit back to it, and has no duration otherwise.
  enum Phase { kReturn, kRamp, kHold, kRelease, kNumPhases };

  std::array<JerkPhase, kNumPhases> phases;
  AxisState start;         // at x = 0
  double v_end = 0.0;      // reached with zero acceleration
  double direction = 1.0;  // sign of the acceleration's peak

  [[nodiscard]] double Duration() const noexcept;
  // The state `t` seconds into the change, x counted from its start; past the end it continues at v_end.
  [[nodiscard]] AxisState At(double t) const noexcept;
  // The distance that the axis travels until the end.
  [[nodiscard]] double Travel() const noexcept;
};

// A change for callers that ask for many times of it: it keeps the states in which the phases begin.
class VelocityPath {
 public:
  VelocityPath() = default;
  explicit VelocityPath(const VelocityChange& change) noexcept;

  // VelocityChange::At, to the last bit. Real-time: yes.
  [[nodiscard]] AxisState At(double t) const noexcept;
  // The state after the change.
  [[nodiscard]] const AxisState& End() const noexcept { return end_; }

 private:
  std::array<JerkPhase, VelocityChange::kNumPhases> phases_;
  std::array<AxisState, VelocityChange::kNumPhases> begins_;
  AxisState end_;
};

// The shortest change from velocity `v0` and acceleration `a0`, which may be beyond its limit, to velocity
// `v1` and no acceleration. `limits.v_max` is not used. Real-time: yes.
[[nodiscard]] VelocityChange PlanVelocityChange(double v0, double a0, double v1,
                                                const AxisLimits& limits) noexcept;

}  // namespace fovea::trajectory
