// SPDX-License-Identifier: Apache-2.0
// Moves the joints' reference from any state to rest at a posture. All joints arrive together, within limits
// of velocity, acceleration and jerk. The method: synchronised_move.hpp.
#pragma once

#include <array>

#include "firmware/core/trajectory/reference.hpp"
#include "firmware/core/trajectory/synchronised_move.hpp"

namespace fovea::link {
struct StateAccess;
}

namespace fovea::trajectory {

class JointMove {
 public:
  using Limits = std::array<AxisLimits, model::kMaxJoints>;

  // Plans from `start` to `q_goal` [num_joints] rad or m; `limits` of the joints, entries past the last
  // unused. A new goal may begin in any tick from the reference that At() gave. False, with the move
  // unchanged, if sizes differ, a value is not finite or a limit is not greater than zero. Real-time: yes.
  [[nodiscard]] bool Plan(const Reference& start, const model::VecN& q_goal, const Limits& limits) noexcept;

  // The reference `t` seconds after the start; exactly q_goal at rest from Duration() on. Real-time: yes.
  void At(double t, Reference& reference) const noexcept;

  [[nodiscard]] double Duration() const noexcept { return move_.Duration(); }

 private:
  friend struct link::StateAccess;  // writes and reads all of it: firmware/core/link/state_fields.hpp
  SynchronisedMove move_;
};

}  // namespace fovea::trajectory
