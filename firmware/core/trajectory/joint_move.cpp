// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/trajectory/joint_move.hpp"

namespace fovea::trajectory {

bool JointMove::Plan(const Reference& start, const model::VecN& q_goal, const Limits& limits) noexcept {
  const Eigen::Index n = q_goal.size();
  if (start.q.size() != n || start.dq.size() != n || start.ddq.size() != n) {
    return false;
  }
  std::array<AxisTask, model::kMaxJoints> tasks;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    tasks[k] = {{start.q[i], start.dq[i], start.ddq[i]}, q_goal[i], limits[k]};
  }
  return move_.Plan(std::span(tasks).first(static_cast<std::size_t>(n)));
}

void JointMove::At(double t, Reference& reference) const noexcept {
  SynchronisedMove::States states;
  move_.At(t, states);
  const int n = move_.NumAxes();
  reference.q.resize(n);
  reference.dq.resize(n);
  reference.ddq.resize(n);
  for (int i = 0; i < n; ++i) {
    const AxisState& state = states[static_cast<std::size_t>(i)];
    reference.q[i] = state.x;
    reference.dq[i] = state.v;
    reference.ddq[i] = state.a;
  }
}

}  // namespace fovea::trajectory
