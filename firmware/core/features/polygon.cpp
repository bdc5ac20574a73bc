// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/polygon.hpp"

namespace fovea::features {

void Polygon::Centre() noexcept {
  model::Vec3 mean = model::Vec3::Zero();
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_corners); ++i) {
    mean += corners[i] / static_cast<double>(num_corners);
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_corners); ++i) {
    corners[i] -= mean;
  }
}

bool ComputeCorners(const Polygon& polygon, const TargetInCamera& target, const model::Pose& X_CO_star,
                    FeatureState& state) noexcept {
  std::array<ImagePoint, Polygon::kMost> now;
  std::array<ImagePoint, Polygon::kMost> goal;
  const TargetInCamera at_goal{X_CO_star, model::Vec3::Zero(), model::Vec3::Zero()};
  if (!target.IsFinite() || !at_goal.IsFinite()) {
    return false;
  }
  const auto n = static_cast<std::size_t>(polygon.num_corners);
  for (std::size_t i = 0; i < n; ++i) {
    if (!ComputePoint(target, polygon.corners[i], now[i]) ||
        !ComputePoint(at_goal, polygon.corners[i], goal[i])) {
      return false;
    }
  }
  state.Resize(2 * polygon.num_corners);
  for (std::size_t i = 0; i < n; ++i) {
    const auto row = static_cast<Eigen::Index>(2 * i);
    state.s.segment<2>(row) = now[i].xy;
    state.s_star.segment<2>(row) = goal[i].xy;
    state.ds_dt_target.segment<2>(row) = now[i].dxy_dt_target;
    state.L_s.middleRows<2>(row) = now[i].L;
  }
  return true;
}

}  // namespace fovea::features
