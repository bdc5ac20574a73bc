// SPDX-License-Identifier: Apache-2.0
#include "sim/render/exposure.hpp"

#include <algorithm>
#include <iterator>

namespace fovea::sim {
namespace {

Eigen::Matrix3d TurnBetween(const Eigen::Matrix3d& before, const Eigen::Matrix3d& after, double share) {
  return Eigen::Quaterniond(before).slerp(share, Eigen::Quaterniond(after)).toRotationMatrix();
}

Eigen::Isometry3d PoseBetween(const Eigen::Isometry3d& before, const Eigen::Isometry3d& after, double share) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = before.translation() + share * (after.translation() - before.translation());
  X.linear() = TurnBetween(before.linear(), after.linear(), share);
  return X;
}

}  // namespace

Moment Between(const Moment& before, const Moment& after, std::int64_t time_ns) {
  const double share =
      static_cast<double>(time_ns - before.time_ns) / static_cast<double>(after.time_ns - before.time_ns);
  Moment moment;
  moment.time_ns = time_ns;
  moment.X_BC = PoseBetween(before.X_BC, after.X_BC, share);
  moment.p_BO = before.p_BO + share * (after.p_BO - before.p_BO);
  moment.R_BO = TurnBetween(before.R_BO, after.R_BO, share);
  for (std::size_t i = 0; i < before.X_BL.size(); ++i) {
    moment.X_BL.push_back(PoseBetween(before.X_BL[i], after.X_BL[i], share));
  }
  return moment;
}

Moment Exposure::At(std::int64_t offset_ns) const {
  if (around == nullptr || around->empty()) {
    return *this;
  }
  const std::int64_t at_ns = time_ns + offset_ns;
  const auto later = std::upper_bound(around->begin(), around->end(), at_ns,
                                      [](std::int64_t t, const Moment& m) { return t < m.time_ns; });
  if (later == around->begin()) {
    return around->front();
  }
  if (later == around->end()) {
    return around->back();
  }
  return Between(*std::prev(later), *later, at_ns);
}

}  // namespace fovea::sim
