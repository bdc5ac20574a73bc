// SPDX-License-Identifier: Apache-2.0
// Estimates what the hand carries, and the joints' friction, from torques and motion.
//
// What the link-side torques do beyond the believed arm's inverse dynamics is linear in the load: its mass
// and its mass times the shift of its centre. (Atkeson, An and Hollerbach, Estimation of inertial parameters
// of manipulator loads and links, 1986.) Torques are averaged over 100 ms, in which the accelerations become
// differences of velocities. Friction is what is lost between the motor's torque and the link's.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/load.hpp"
#include "firmware/host/beliefs/belief.hpp"
#include "fovea/hal/record.hpp"

namespace fovea::beliefs {

struct ArmEstimate {
  int windows = 0;  // used; 0: too few
  std::vector<Belief> beliefs;
};

class ArmEstimator {
 public:
  // `load`: what the servo believes that the hand carries, already part of its arm.
  ArmEstimator(const config::ServoConfig& config, const model::Load& load);

  void Add(const hal::TickRecord& record);
  [[nodiscard]] ArmEstimate Estimate() const;

 private:
  static constexpr int kLoads = 4;  // mass, and mass times shift

  // The believed dynamics, and those of each unknown.
  struct Sample {
    model::VecN dq;
    model::ArmDynamics believed;
    std::vector<model::ArmDynamics> unknown;
  };
  struct Torques {
    model::VecN link;   // measured behind the gear, gravity included
    model::VecN motor;  // commanded, gravity excluded
  };
  // Means over a window [Nm, N].
  struct Window {
    model::VecN torque;          // of the links, beyond the believed arm's
    Eigen::MatrixXd regressors;  // torques per unit of each unknown
    model::VecN friction;        // lost in the joints
    model::VecN dq;
    model::VecN dq_least;  // smallest speed in the window, with its sign; 0: it changed its sign
  };

  [[nodiscard]] Sample Evaluate(const hal::TickRecord& record) const;
  [[nodiscard]] Torques TorquesOf(const hal::TickRecord& record) const;
  void AddPart(const Sample& begin, const Sample& end);
  void Begin(const hal::TickRecord& record);
  void EstimateLoad(ArmEstimate& estimate) const;
  void EstimateFriction(int joint, ArmEstimate& estimate) const;

  const config::ServoConfig config_;  // without rotors
  const model::VecN rotor_inertia_;   // [num_joints; kg m^2, kg]
  const model::Load load_;
  std::vector<model::ArmModel> arms_;  // the believed arm with one unknown changed by its unit step
  std::vector<double> steps_;
  std::deque<Window> windows_;
  // The window that is being filled.
  bool open_ = false;
  int ticks_ = 0;
  std::int64_t stamp_ns_ = 0;
  Sample sample_;
  Torques torques_;
  Window window_;
};

}  // namespace fovea::beliefs
