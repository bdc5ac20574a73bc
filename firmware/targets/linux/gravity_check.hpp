// SPDX-License-Identifier: Apache-2.0
// Compares the measured joint torques of an arm at rest with the model's gravity.
#pragma once

#include <string>

#include "firmware/core/model/arm_model.hpp"
#include "fovea/hal/arm.hpp"

namespace fovea::hw {

struct GravityFinding {
  double worst_nm = 0.0;         // largest difference of all joints, measured minus model
  int joint = 0;                 // the joint with that difference, from 0
  double unknown_mass_kg = 0.0;  // mass at the end effector that fits all joints best (least squares)
};

// `tau_meas` [num_joints], gravity included, of an arm at rest at `q`: there the torques are only gravity,
// whichever controller holds the arm. NaN for values that are not finite.
[[nodiscard]] GravityFinding CompareGravity(const model::ArmModel& arm, const hal::JointArray& q,
                                            const hal::JointArray& tau_meas);

// "measured torques differ from the model by 3.4 Nm at joint 2, as with 0.7 kg too much at the end effector".
[[nodiscard]] std::string InWords(const GravityFinding& finding);

// The mean over consecutive states of an arm at rest.
class RestMean {
 public:
  // At rest: every joint slower than `rest_speed` [rad/s]. `states` [>= 1]: number of consecutive states.
  RestMean(int states, double rest_speed) : states_(states), rest_speed_(rest_speed) {}

  [[nodiscard]] int states() const noexcept { return states_; }
  // Takes the next state; true once the mean is complete. Real-time: yes.
  bool Add(const hal::ArmState& state) noexcept;
  // True after kPatience times `states` states: the arm does not come to rest.
  [[nodiscard]] bool IsInVain() const noexcept { return seen_ >= kPatience * states_; }

  [[nodiscard]] hal::JointArray q() const noexcept { return Divided(q_); }
  [[nodiscard]] hal::JointArray tau_meas() const noexcept { return Divided(tau_); }

 private:
  static constexpr int kPatience = 20;
  [[nodiscard]] hal::JointArray Divided(hal::JointArray sum) const noexcept;

  int states_;
  double rest_speed_;
  int seen_ = 0;
  int count_ = 0;
  hal::JointArray q_{};
  hal::JointArray tau_{};
};

}  // namespace fovea::hw
