// SPDX-License-Identifier: Apache-2.0
// Moves several axes from any state to rest at a goal, where they arrive at the same time: the joints of an
// arm, or the six coordinates of a pose.
//
// From rest the axes move along the straight line to the goal (phase synchronised): one move over the line's
// length, limited by the axis that reaches a limit first. From any other state there is no straight line: the
// slowest axis moves as fast as possible, and every other takes as long (time synchronised). A new goal may
// begin at any time from the state that At() gives; the new move starts exactly there.
//
// The move of one axis: axis_move.hpp.
#pragma once

#include <array>
#include <span>

#include "firmware/core/model/types.hpp"
#include "firmware/core/trajectory/axis_move.hpp"

namespace fovea::link {
struct StateAccess;
}

namespace fovea::trajectory {

// The task of one axis: [m or rad, and per s, s^2, s^3]
struct AxisTask {
  AxisState start;
  double goal_x = 0.0;
  AxisLimits limits;
};

class SynchronisedMove {
 public:
  static constexpr int kMaxAxes = model::kMaxJoints;
  using States = std::array<AxisState, kMaxAxes>;

  // Plans a new move. False, with the old one unchanged, if there are more than kMaxAxes tasks, a value is
  // not finite or a limit is not greater than zero. Real-time: yes, some 10 us for 7 axes.
  [[nodiscard]] bool Plan(std::span<const AxisTask> tasks) noexcept;

  // The states of all axes `t` seconds after the start; exactly at rest at the goal from Duration() on.
  // Entries past the last axis are unchanged. Real-time: yes.
  void At(double t, States& states) const noexcept;

  [[nodiscard]] int NumAxes() const noexcept { return num_axes_; }
  [[nodiscard]] double Duration() const noexcept { return duration_s_; }

 private:
  friend struct link::StateAccess;  // writes and reads all of it: firmware/core/link/state_fields.hpp
  void PlanLine(std::span<const AxisTask> tasks) noexcept;
  void PlanTimes(std::span<const AxisTask> tasks) noexcept;

  int num_axes_ = 0;
  double duration_s_ = 0.0;
  bool straight_ = false;
  std::array<AxisMove, kMaxAxes> moves_;  // straight: the first only, from -1 to 0 along the line
  std::array<double, kMaxAxes> goal_{};
  std::array<double, kMaxAxes> way_{};  // straight: from start to goal
};

}  // namespace fovea::trajectory
