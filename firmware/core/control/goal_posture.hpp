// SPDX-License-Identifier: Apache-2.0
// Searches, while the arm moves, for a posture in which the camera is at its goal relative to the target.
//
// The visual law only descends. With all six degrees of freedom controlled, it may stop at the end of a
// joint's range although another posture reaches the goal. A square also looks the same after each quarter
// turn, and one of these goals may be out of reach. The search tries postures by Gauss-Newton on the camera's
// pose, one step at a time. It first starts at the arm's posture, for each equal turn of the target, nearest
// first. Then it starts, in rounds, at random postures further and further from the arm's. Each round takes
// the nearest posture that the joints can reach with the target in view: straight, or by a detour towards a
// random posture. After some rounds without one, it takes the nearest posture whose path is barred. A posture
// that was found follows the target's estimate.
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
  bool begun = false;     // a trial is under way
  bool reached = false;   // the trial has reached the goal; its path is being tried
  bool downhill = false;  // the posture was found from the arm's own posture
  bool clear = false;     // its path was clear when the posture was found
  int turn = 0;           // equal turn of the target about its z, for the last posture found
  int trial_turn = 0;     // and for the trial
  int trial = 0;          // number of the current one, or of the one that found the posture
  int step = 0;           // of the trial; once a posture is found: steps in a row that it is off the goal
  double last_off = HUGE_VAL;  // of the trial: distance from the goal at the last check
  model::VecN q;               // [num_joints] of the trial, or the posture found
  WayTrial way;                // the trial of the path to q
  int detour = 0;  // number of the one that is tried, 0: straight; once found: 1 if the path goes by q_via
  int detour_steps = 0;  // largest number of steps towards q_via
  bool turned = false;   // the trial has reached q_via and continues to the posture
  model::VecN q_via;     // [num_joints] waypoint of the trial, or of the path found
  std::uint32_t random = 1;

  double nearest = HUGE_VAL;  // length of the round's best path, plus a penalty if barred [rad]
  int nearest_turn = 0;
  bool nearest_detour = false;
  model::VecN q_nearest;
  model::VecN q_nearest_via;
  int drops = 0;  // postures that could not be reached; q_dropped holds the last ones
  std::array<model::VecN, kDropsKept> q_dropped;
};

// True if the arm can take any pose, and the target's feature determines the camera's pose, or all of it
// except the orientation: then the search has a defined goal.
[[nodiscard]] bool SeeksGoalPosture(const config::ServoConfig& config) noexcept;

// True if the orientation is free: many postures reach the goal, and the law usually finds one by itself.
[[nodiscard]] bool SeeksWhenIdle(const config::ServoConfig& config) noexcept;

// Makes one step. `X_BO`: the target's estimate; `q` [num_joints]: the arm's posture. Real-time: yes.
void SeekGoalPosture(const config::ServoConfig& config, const model::Pose& X_BO, const model::VecN& q,
                     GoalPosture& goal) noexcept;

// Restarts the search from the arm's current posture. Keeps a square's turn: a new one would only make the
// camera start sideways. Real-time: yes.
void SeekAnew(GoalPosture& goal) noexcept;

// Continues with the next trial, for a posture with a clear path. Real-time: yes.
void SeekClearerPosture(GoalPosture& goal) noexcept;

// Call if the posture cannot be reached. Continues with the next trial, for another one. Real-time: yes.
void DropGoalPosture(GoalPosture& goal) noexcept;

// The `turn`-th of `turns` equal turns about z; exact for quarter turns. Real-time: yes.
[[nodiscard]] model::Mat3 EqualTurn(int turn, int turns) noexcept;

}  // namespace fovea::control
