// Kalman filter of a target's position and velocity in the base frame: constant velocity, disturbed by
// white acceleration. Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation
// (2001), section 6.2.
#pragma once

#include <cstdint>

#include "fovea/model/types.hpp"
#include "fovea/servo/servo_config.hpp"

namespace fovea::servo {

// Estimate at `stamp_ns`, the stamp of the last accepted measurement. Blocks of the covariance: pp, pv, vv.
struct TargetFilter {
  int accepted = 0;  // measurements since the start; 0: nothing is known
  int rejected_in_row = 0;
  std::int64_t stamp_ns = 0;
  model::Vec3 p_BO = model::Vec3::Zero();
  model::Vec3 v_BO = model::Vec3::Zero();
  model::Mat3 P_pp = model::Mat3::Zero();
  model::Mat3 P_pv = model::Mat3::Zero();
  model::Mat3 P_vv = model::Mat3::Zero();
};

// Takes in the measured centre `p_BO` [m] in B, true at `stamp_ns`, with covariance `cov_B` [m^2]. An
// outlier is left out; after too many in a row the filter starts anew there. Real-time: yes.
void Update(const PredictConfig& config, std::int64_t stamp_ns, const model::Vec3& p_BO,
            const model::Mat3& cov_B, TargetFilter& filter) noexcept;

// Where the target is at `now_ns` [m], by the filter's velocity. Real-time: yes.
model::Vec3 PositionAt(const TargetFilter& filter, std::int64_t now_ns) noexcept;

}  // namespace fovea::servo
