// A posture in which the camera has the target where it shall be, looked for while the arm moves.
//
// The visual law goes downhill. Where all six degrees of freedom are controlled, that may end at the end of a
// joint's range although another posture reaches the goal; and a square looks the same after each quarter
// turn, one of which may be out of reach. So postures are tried by Gauss-Newton on the camera's pose, a step
// at a time: from where the arm is, to each of the target's equal turns, the nearest first; then in rounds
// from postures beside it, further and further off, and of those that a round finds the nearest is taken to
// which the joints can go with the target in view, straight or by way of another posture, drawn at random
// and gone towards for a while; when some rounds find none such, the least barred. Once one is found it
// follows the target's estimate.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/control/way_in_view.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::control {

struct GoalPosture {
  static constexpr int kDropsKept = 4;

  bool found = false;
  bool begun = false;          // a trial is under way
  bool reached = false;        // the trial has reached the goal, and the way there is tried
  bool downhill = false;       // the posture was found from where the arm was
  bool clear = false;          // the way to it was, when it was found
  int turn = 0;                // the target's equal turn about its z for which the last posture found is
  int trial_turn = 0;          // and for which the trial is
  int trial = 0;               // that is under way, or led to the posture
  int step = 0;                // of the trial; of a posture that was found, how long it has been off the goal
  double last_off = HUGE_VAL;  // of the trial: how far it was from the goal when last looked at
  model::VecN q;               // of the trial, or the posture [num_joints]
  WayTrial way;                // there
  int detour = 0;              // that is tried, 0: straight; or whether the posture is gone to by q_via
  int detour_steps = 0;        // that it goes towards q_via, at most
  bool turned = false;         // the trial has come to q_via, and goes on to the posture
  model::VecN q_via;           // where the trial goes first, or the way to the posture [num_joints]
  std::uint32_t random = 1;

  double nearest =
      HUGE_VAL;  // of the round: how long the way to its best posture is [rad], a barred one longer
  int nearest_turn = 0;
  bool nearest_detour = false;
  model::VecN q_nearest;
  model::VecN q_nearest_via;
  int drops = 0;  // postures that could not be reached, and the last of them
  std::array<model::VecN, kDropsKept> q_dropped;
};

// Whether the arm can take any pose, and the target's feature leaves the camera's none or nothing but its
// orientation free, so that it is clear what to look for.
[[nodiscard]] bool SeeksGoalPosture(const config::ServoConfig& config) noexcept;

// Whether the orientation is free: many postures reach the goal, and the law most often finds one by itself.
[[nodiscard]] bool SeeksWhenIdle(const config::ServoConfig& config) noexcept;

// One step. `X_BO`: the target's estimate; `q` [num_joints]: where the arm is. Real-time: yes.
void SeekGoalPosture(const config::ServoConfig& config, const model::Pose& X_BO, const model::VecN& q,
                     GoalPosture& goal) noexcept;

// Begins anew, from where the arm is now. A square stays turned as it was: the camera would start to the side
// for nothing else. Real-time: yes.
void SeekAnew(GoalPosture& goal) noexcept;

// Goes on with the next trial, for a posture with a clear way to it. Real-time: yes.
void SeekClearerPosture(GoalPosture& goal) noexcept;

// The posture cannot be reached: goes on with the next trial, for another one. Real-time: yes.
void DropGoalPosture(GoalPosture& goal) noexcept;

// The `turn`-th of `turns` equal turns about z; exact where they are quarters. Real-time: yes.
[[nodiscard]] model::Mat3 EqualTurn(int turn, int turns) noexcept;

}  // namespace fovea::control
