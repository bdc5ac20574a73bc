// SPDX-License-Identifier: Apache-2.0
#include "sim/calibration/place_hand.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace fovea::sim {

std::optional<Eigen::VectorXd> PlaceHand(const Chain& chain, const model::ArmModel& limits, Eigen::VectorXd q,
                                         const Eigen::Isometry3d& X_BE) {
  constexpr int kRounds = 300;
  constexpr double kThere = 1e-9;        // accepted error [m, rad]
  constexpr double kFarthest = 0.2;      // largest step [m, rad]
  constexpr double kFromTheEnds = 0.05;  // margin to each joint's limits [rad, m]
  Jacobian J;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Isometry3d X_now = chain.TipPose(q, J);
    Eigen::Matrix<double, 6, 1> off;
    const Eigen::AngleAxisd turn(Eigen::Matrix3d(X_BE.linear() * X_now.linear().transpose()));
    off << X_BE.translation() - X_now.translation(), turn.angle() * turn.axis();
    if (off.norm() < kThere) {
      return q;
    }
    // Damping prevents jumps far from the goal. It vanishes near the goal, for quadratic convergence.
    const double damping = 1e-2 * std::min(1.0, off.squaredNorm());
    off *= std::min(1.0, kFarthest / off.norm());
    const Eigen::Matrix<double, 6, 6> A =
        J * J.transpose() + (damping + 1e-12) * Eigen::Matrix<double, 6, 6>::Identity();
    q += J.transpose() * A.ldlt().solve(off);
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const model::Joint& joint = limits.joints[static_cast<std::size_t>(i)];
      q[i] = std::clamp(q[i], joint.q_min + kFromTheEnds, joint.q_max - kFromTheEnds);
    }
  }
  return std::nullopt;
}

}  // namespace fovea::sim
