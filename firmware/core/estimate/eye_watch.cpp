// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/eye_watch.hpp"

namespace fovea::estimate {
namespace {

constexpr double kFades = 0.967;        // per measurement: a time constant of 1 s at 30 Hz
constexpr double kEnoughShifts = 20.0;  // times servo.stuck_shift_px: a shift large enough to judge
constexpr double kAgainst = -0.7;       // share of the predicted shift that counts as opposite
constexpr double kNearest = 0.01;       // a target nearer to the camera's plane is ignored [m]
constexpr double kNear = 0.15;          // an error below this share of the goal's size is never doubted
constexpr double kProgress = 0.9;       // an error that is smaller by this factor is progress

}  // namespace

void WatchPicture(const config::PredictConfig& config, const model::Pose& X_BC, const model::Vec3& p_CO_C,
                  EyeWatch& watch) noexcept {
  if (watch.has_last && watch.p_CO_C_last.z() > kNearest && p_CO_C.z() > kNearest) {
    const model::Vec3 still = X_BC.Inverse() * (watch.X_BC_last * watch.p_CO_C_last);
    for (std::size_t i = 0; i < 2 && still.z() > kNearest; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      const double last = watch.p_CO_C_last[axis] / watch.p_CO_C_last.z();
      const double d = still[axis] / still.z() - last;
      const double s = p_CO_C[axis] / p_CO_C.z() - last;
      watch.predicted[i] = kFades * watch.predicted[i] + d * d;
      watch.seen[i] = kFades * watch.seen[i] + s * d;
      const double enough = kEnoughShifts * config.stuck_shift;
      if (watch.predicted[i] > enough * enough && watch.seen[i] < kAgainst * watch.predicted[i]) {
        watch.doubted = true;
      }
    }
  }
  watch.has_last = true;
  watch.X_BC_last = X_BC;
  watch.p_CO_C_last = p_CO_C;
}

void WatchSteering(const config::PredictConfig& config, double error, double speed,
                   EyeWatch& watch) noexcept {
  if (error < kNear || watch.least_error == 0.0 || error < kProgress * watch.least_error) {
    watch.least_error = error < kNear ? 0.0 : error;
    watch.way = 0.0;
    return;
  }
  watch.way += speed * hal::kTickPeriodS;
  if (watch.way > config.way_in_vain) {
    watch.doubted = true;
  }
}

}  // namespace fovea::estimate
