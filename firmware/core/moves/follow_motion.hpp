// SPDX-License-Identifier: Apache-2.0
// Stage 3 in mode Move: the reference follows the commanded motion within all limits.
//
// Joint goals are planned online, jerk-limited and synchronised (joint_move.hpp), and so are the six
// coordinates of a pose goal (synchronised_move.hpp). Joint setpoints, planned or streamed, become the
// reference unchanged if they keep every limit and the arm can still stop inside all of them. Poses are
// converted to joint velocities first, and pass the guard like the visual law's.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/resolve_motion.hpp"
#include "firmware/core/guard/known_clearances.hpp"
#include "firmware/core/moves/motion_command.hpp"
#include "firmware/core/trajectory/joint_move.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "firmware/core/trajectory/synchronised_move.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::moves {

struct MotionState {
  MotionCommand goal;  // the one under way; kNone if there is none
  MotionCommand done;  // the last one reached, while it is still commanded; else kNone
  std::int64_t start_ns = 0;
  trajectory::JointMove joints;
  model::Pose X_BE;                   // of a pose goal
  trajectory::SynchronisedMove pose;  // position less goal, and the turn from the goal, both in axes of B
  control::ResolvedMotion resolved;   // joint motion of the last pose; empty dq: there was none
  bool refused = false;               // in the last tick
  model::VecN off;                    // mean of reference less arm [rad, m]; 0 without a motion

  // True if a motion continues after this tick without another command.
  [[nodiscard]] bool IsUnderWay() const noexcept { return goal.kind != MotionKind::kNone; }
  // True if the commanded goal was reached; it does not start again.
  [[nodiscard]] bool HasArrived() const noexcept { return done.kind != MotionKind::kNone; }
  void Stop() noexcept { goal.kind = MotionKind::kNone; }
};

// Call before the modes. Clears `state.done` if `asked` is not the goal that was reached. Real-time: yes.
void NoteAsked(const config::ServoConfig& config, const MotionCommand& asked, MotionState& state) noexcept;

// One tick of a commanded motion: advances `reference`. Returns the limits that acted or forbade it. If they
// or an invalid command forbid it, sets `state.refused` and brakes. `known`: as for guard::LimitsPassed.
// Real-time: yes; a new goal takes some 10 us.
hal::LimitSet FollowMotion(const config::ServoConfig& config, const MotionCommand& asked, std::int64_t now_ns,
                           MotionState& state, guard::KnownClearances& known,
                           trajectory::Reference& reference) noexcept;

}  // namespace fovea::moves
