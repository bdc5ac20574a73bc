// SPDX-License-Identifier: Apache-2.0
// The sensors of the arm: encoders and torque sensors.
#include "sim/drives/round_to.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

Eigen::VectorXd World::EncoderZero() const {
  const Eigen::VectorXd& zero = config_.robot_truth.encoder_zero;
  return zero.size() > 0 ? zero : Eigen::VectorXd::Zero(arm_.num_dofs());
}

Eigen::VectorXd World::Reading() const {
  return (elastic_ && config_.encoder_on_motor ? MotorPosition() : arm_.q()) + EncoderZero();
}

const Eigen::VectorXd& World::ReadingSpeed() const {
  return elastic_ && config_.encoder_on_motor ? elastic_->motor_speed() : arm_.dq();
}

// What a joint's sensor reads of a motor's torque.
double World::SensedTorque(double tau, Eigen::Index joint) const {
  const RobotTruth& truth = config_.robot_truth;
  return truth.torque_scale.size() > 0 ? (tau - truth.torque_bias[joint]) / truth.torque_scale[joint] : tau;
}

void World::MeasureState() {
  measured_.stamp_ns = now_ns_;
  ++measured_.sequence;
  const Eigen::VectorXd motor = MotorTorque();
  const Eigen::VectorXd zero = EncoderZero();
  const Eigen::VectorXd q = elastic_ && config_.encoder_on_motor ? MotorPosition() : arm_.q();
  const Eigen::VectorXd& dq = ReadingSpeed();
  const Eigen::VectorXd stiction = arm_.StictionTorque();
  for (int i = 0; i < arm_.num_dofs(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    measured_.q[k] =
        RoundTo(q[i] + zero[i] + config_.encoder_noise * normal_(random_), config_.encoder_quantum);
    measured_.dq[k] =
        speeds_.empty() ? dq[i] + config_.velocity_noise * normal_(random_) : speeds_[k].Next(measured_.q[k]);
    measured_.tau_applied[k] = command_.tau_cmd[k];
    measured_.tau_meas[k] = elastic_ ? SensedTorque(motor[i], i) - motor[i] + elastic_->torque()[i]
                                     : SensedTorque(motor[i], i) - friction_.Torque(i, arm_.dq()[i]) +
                                           stiction[i] - rotor_torque_[i];
  }
}

}  // namespace fovea::sim
