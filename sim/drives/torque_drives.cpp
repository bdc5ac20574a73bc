// SPDX-License-Identifier: Apache-2.0
#include "sim/drives/torque_drives.hpp"

namespace fovea::sim {

TorqueDrives::TorqueDrives(const std::vector<TorqueDriveConfig>& drives, const Eigen::VectorXd& tau)
    : drives_(drives.begin(), drives.end()), delivered_(tau) {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    delivered_[k] = drives_[i].Settle(tau[k]);
  }
  error_ = delivered_ - tau;
}

void TorqueDrives::Step(const Eigen::VectorXd& tau, const Eigen::VectorXd& q, const Eigen::VectorXd& dq) {
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    delivered_[k] = drives_[i].Step(tau[k], q[k], dq[k]);
  }
  error_ = delivered_ - tau;
}

}  // namespace fovea::sim
