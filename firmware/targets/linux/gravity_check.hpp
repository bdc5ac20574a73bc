// What the joints of a resting arm feel beside what the model says that they carry.
#pragma once

#include <string>

#include "firmware/core/model/arm_model.hpp"
#include "fovea/hal/arm.hpp"

namespace fovea::hw {

struct GravityFinding {
  double worst_nm = 0.0;         // of all joints, measured less the model's
  int joint = 0;                 // where, from 0
  double unknown_mass_kg = 0.0;  // at the end effector, that would explain all joints best
};

// `tau_meas` [num_joints], gravity included, of an arm at rest at `q`: then they are its gravity and nothing
// else, whoever holds it. NaN where a value is not finite.
[[nodiscard]] GravityFinding CompareGravity(const model::ArmModel& arm, const hal::JointArray& q,
                                            const hal::JointArray& tau_meas);

// "measured torques are 3.41 Nm off the model's at joint 2, as of 0.70 kg at the end effector".
[[nodiscard]] std::string InWords(const GravityFinding& finding);

// The mean over states in a row of an arm at rest.
class RestMean {
 public:
  // At rest: every joint slower than `rest_speed` [rad/s]. `states` [>= 1]: so many in a row.
  RestMean(int states, double rest_speed) : states_(states), rest_speed_(rest_speed) {}

  [[nodiscard]] int states() const noexcept { return states_; }
  // Takes the next state; true once the mean is there. Real-time: yes.
  bool Add(const hal::ArmState& state) noexcept;
  // So many states came without it, and the arm does not come to rest.
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
