// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/eye_watch.hpp"

#include <cmath>

namespace fovea::estimate {
namespace {

constexpr double kFades = 0.967;        // per measurement: a time constant of 1 s at 30 Hz
constexpr double kEnoughShifts = 20.0;  // times servo.stuck_shift_px: a shift large enough to judge
constexpr double kFewShifts = 2.5;      // large enough for a suspicion
constexpr double kAgainst = -0.7;       // share of the predicted shift that counts as opposite
constexpr double kAside = 0.5;          // cosine of the turn from which on steering leads away: 60 degrees
constexpr double kShare2 = 0.25;        // of the squares of the other shifts
constexpr double kOneTurn = 0.8;   // share of what is seen that one turn of the predicted shifts explains
constexpr double kNearest = 0.01;  // a target nearer to the camera's plane is ignored [m]
constexpr double kNear = 0.15;     // an error below this share of the goal's size is never doubted
constexpr double kProgress = 0.9;  // an error that is smaller by this factor is progress

// True if the scene shifts as predicted, but turned by so much that steering leads away from the goal. As
// complex numbers, S_k = a D_k has the least squares solution a = sum S_k conj(D_k) / sum |D_k|^2.
bool IsTurned(const EyeWatch& watch) noexcept {
  const double size2 = watch.along * watch.along + watch.aside * watch.aside;
  const double gain2 = size2 / (watch.predicted2 * watch.predicted2);
  const bool as_large = gain2 > 0.4 && gain2 < 2.5;  // another size is a target's own motion
  // With wrong stamps a part of the other shifts passes for these: to turn them by 60 degrees it would have
  // to be most of them.
  const bool is_most = watch.predicted2 > kShare2 * watch.by_axis2;
  return as_large && is_most && size2 > kOneTurn * watch.predicted2 * watch.seen2 &&
         watch.along < kAside * std::sqrt(size2);
}

// True if the picture contradicts the hand's motion, judged from shifts of at least `enough`.
bool Contradicts(const EyeWatch& watch, double enough) noexcept {
  const double enough2 = enough * enough;
  const auto against = [&](std::size_t i) {
    return watch.predicted[i] > enough2 && watch.seen[i] < kAgainst * watch.predicted[i];
  };
  return against(0) || against(1) || (watch.predicted2 > enough2 && IsTurned(watch));
}

}  // namespace

void WatchPicture(const config::PredictConfig& config, const model::Pose& X_BC, const model::Vec3& p_CO_C,
                  EyeWatch& watch) noexcept {
  const model::Vec3& last = watch.p_CO_C_last;
  const model::Pose X_now_last = X_BC.Inverse() * watch.X_BC_last;
  const model::Vec3 still = X_now_last * last;
  if (watch.has_last && last.z() > kNearest && p_CO_C.z() > kNearest && still.z() > kNearest) {
    const Eigen::Vector2d from = last.head<2>() / last.z();
    const Eigen::Vector2d d = still.head<2>() / still.z() - from;
    const Eigen::Vector2d s = p_CO_C.head<2>() / p_CO_C.z() - from;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      watch.predicted[i] = kFades * watch.predicted[i] + d[axis] * d[axis];
      watch.seen[i] = kFades * watch.seen[i] + s[axis] * d[axis];
    }
    const double turn = 0.5 * (X_now_last.R(1, 0) - X_now_last.R(0, 1));
    const double nearer = X_now_last.p.z() / last.z();
    const Eigen::Vector2d by_axis = turn * Eigen::Vector2d(-from.y(), from.x()) - nearer * from;
    const Eigen::Vector2d D = d - by_axis;
    const Eigen::Vector2d S = s - by_axis;
    watch.predicted2 = kFades * watch.predicted2 + D.squaredNorm();
    watch.seen2 = kFades * watch.seen2 + S.squaredNorm();
    watch.along = kFades * watch.along + S.dot(D);
    watch.aside = kFades * watch.aside + D.x() * S.y() - D.y() * S.x();
    watch.by_axis2 = kFades * watch.by_axis2 + by_axis.squaredNorm();
    watch.doubted = watch.doubted || Contradicts(watch, kEnoughShifts * config.stuck_shift);
    // Of at least a quarter of servo.stuck_shift_px.
    if (watch.shifts < EyeWatch::kFewestShifts && D.norm() > 0.25 * config.stuck_shift) {
      ++watch.shifts;
    }
    watch.suspected =
        watch.shifts == EyeWatch::kFewestShifts && Contradicts(watch, kFewShifts * config.stuck_shift);
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
