// SPDX-License-Identifier: Apache-2.0
// The drives of all joints.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/drives/torque_drive.hpp"

namespace fovea::sim {

class TorqueDrives {
 public:
  // `drives`: one per moving joint. `tau` [num_dofs; Nm, N] was commanded for ever before.
  TorqueDrives(const std::vector<TorqueDriveConfig>& drives, const Eigen::VectorXd& tau);

  // Advances by one tick from the motion `q`, `dq` [num_dofs; rad, m] under the command `tau`.
  void Step(const Eigen::VectorXd& tau, const Eigen::VectorXd& q, const Eigen::VectorXd& dq);

  // Mean torques of the last tick [num_dofs; Nm, N], and their difference to the command.
  [[nodiscard]] const Eigen::VectorXd& delivered() const { return delivered_; }
  [[nodiscard]] const Eigen::VectorXd& error() const { return error_; }

 private:
  std::vector<TorqueDrive> drives_;
  Eigen::VectorXd delivered_;
  Eigen::VectorXd error_;
};

}  // namespace fovea::sim
