// SPDX-License-Identifier: Apache-2.0
// An arm that follows its model exactly, without gravity and friction (a hal::Arm compensates both itself):
// M(q) ddq + C(q, dq) dq = tau, integrated with many small steps. For closed loops without a simulator.
#pragma once

#include <Eigen/Cholesky>

#include "firmware/core/model/dynamics.hpp"
#include "fovea/hal/arm.hpp"

namespace fovea::test {

class IdealArm {
 public:
  IdealArm(const model::ArmModel& model, const model::VecN& q) : model_(model), q_(q) {
    dq_ = model::VecN::Zero(q.size());
    tau_ = model::VecN::Zero(q.size());
  }

  void Apply(const hal::ArmCommand& command) {
    tau_ = model::ToVector(command.tau_cmd, model_.num_joints);
    braked_ = command.engage_brakes;
  }

  // Simulates one millisecond.
  void Step() {
    constexpr int kSubSteps = 4;
    constexpr double kDt = 1e-3 / kSubSteps;
    for (int i = 0; i < kSubSteps && !braked_ && !jammed_; ++i) {
      model::ArmPoses poses;
      model::ArmDynamics dynamics;
      model::ComputePoses(model_, q_, poses);
      model::ComputeDynamics(model_, poses, dq_, dynamics);
      const Eigen::MatrixXd M = dynamics.M;
      const Eigen::VectorXd ddq = M.ldlt().solve(Eigen::VectorXd(tau_ - dynamics.Cdq));
      dq_ += kDt * ddq;
      q_ += kDt * dq_;
    }
    if (braked_ || jammed_) {
      dq_.setZero();
    }
    stamp_ns_ += hal::kTickPeriodNs;
    ++sequence_;
  }

  [[nodiscard]] hal::ArmState State() const {
    hal::ArmState state;
    state.stamp_ns = stamp_ns_;
    state.sequence = sequence_;
    state.num_joints = model_.num_joints;
    state.q = model::ToArray(q_);
    state.dq = model::ToArray(dq_);
    state.tau_applied = model::ToArray(tau_);
    return state;
  }

  [[nodiscard]] const model::VecN& q() const { return q_; }
  [[nodiscard]] const model::VecN& dq() const { return dq_; }
  // From now on the arm stands still.
  void Jam() { jammed_ = true; }
  void SetVelocity(const model::VecN& dq) { dq_ = dq; }

 private:
  model::ArmModel model_;
  model::VecN q_;
  model::VecN dq_;
  model::VecN tau_;
  bool braked_ = false;
  bool jammed_ = false;
  std::int64_t stamp_ns_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace fovea::test
