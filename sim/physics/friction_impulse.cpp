// SPDX-License-Identifier: Apache-2.0
#include "sim/physics/friction_impulse.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::sim {

Eigen::VectorXd FrictionImpulse(const Eigen::MatrixXd& W, const Eigen::VectorXd& v,
                                const Eigen::VectorXd& most) {
  constexpr int kMostSweeps = 1000;
  constexpr double kStill = 1e-15;  // change of a speed [rad/s, m/s]
  Eigen::VectorXd j = Eigen::VectorXd::Zero(v.size());
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double change = 0.0;
    for (Eigen::Index i = 0; i < v.size(); ++i) {
      const double speed = v[i] + W.row(i).dot(j);
      const double wanted = std::clamp(j[i] - speed / W(i, i), -most[i], most[i]);
      change = std::max(change, std::fabs(wanted - j[i]) * W(i, i));
      j[i] = wanted;
    }
    if (change < kStill) {
      break;
    }
  }
  return j;
}

}  // namespace fovea::sim
