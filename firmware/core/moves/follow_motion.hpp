// Stage 3 in mode Move: the reference follows what was commanded, as far as it may.
//
// Joint goals are planned online, jerk-limited and synchronised (joint_move.hpp), and so are the six
// coordinates of a pose goal (synchronised_move.hpp). Joint setpoints, planned or streamed, become the
// reference as they are, if they keep every limit and the arm could still stop inside all of them. Poses are
// brought to joint velocities first and go through the guard like the visual law's.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/resolve_motion.hpp"
#include "firmware/core/moves/motion_command.hpp"
#include "firmware/core/trajectory/joint_move.hpp"
#include "firmware/core/trajectory/reference.hpp"
#include "firmware/core/trajectory/synchronised_move.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::moves {

struct MotionState {
  MotionCommand goal;  // the one under way, kNone when there is none
  MotionCommand done;  // the last one that came to its end, while it is asked for on; else kNone
  std::int64_t start_ns = 0;
  trajectory::JointMove joints;
  model::Pose X_BE;                   // a pose goal's
  trajectory::SynchronisedMove pose;  // position less goal, and the turn from the goal, both in axes of B
  control::ResolvedMotion resolved;   // what the last pose asked of the joints; its dq empty: none did
  bool refused = false;               // in the last tick
  model::VecN off;                    // reference less arm, as a mean [rad, m]; 0 where none is followed

  // Whether a motion goes on after this tick without another command.
  [[nodiscard]] bool IsUnderWay() const noexcept { return goal.kind != MotionKind::kNone; }
  // Whether what is asked for was reached: it is not begun again.
  [[nodiscard]] bool HasArrived() const noexcept { return done.kind != MotionKind::kNone; }
  void Stop() noexcept { goal.kind = MotionKind::kNone; }
};

// Before the modes: where `asked` is not the goal that was reached, and has been asked for ever since,
// `state.done` is forgotten. Real-time: yes.
void NoteAsked(const config::ServoConfig& config, const MotionCommand& asked, MotionState& state) noexcept;

// One tick of a commanded motion: moves `reference` on. Returns the limits that acted or forbade it; where
// they, or a command that is none, forbid it, `state.refused` is set and the reference brakes.
// Real-time: yes; a new goal takes some 10 us.
hal::LimitSet FollowMotion(const config::ServoConfig& config, const MotionCommand& asked, std::int64_t now_ns,
                           MotionState& state, trajectory::Reference& reference) noexcept;

}  // namespace fovea::moves
