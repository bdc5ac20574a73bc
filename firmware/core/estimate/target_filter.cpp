// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/target_filter.hpp"

#include <Eigen/LU>  // inverse of a 3x3
#include <algorithm>
#include <cmath>

#include "firmware/core/estimate/first_sight.hpp"
#include "firmware/core/estimate/shortened.hpp"
#include "firmware/core/estimate/stamp_error.hpp"

namespace fovea::estimate {
namespace {

using model::Mat3;
using model::Vec3;

constexpr int kOrder = TargetFilter::kOrder;
constexpr double kJerkTime = 0.1;  // the configured jerk is a mean over this [s]

void StartAt(const MeasuredCentre& measured, TargetFilter& filter) noexcept {
  filter = TargetFilter{};
  filter.late = measured.late;
  filter.P_late = measured.late_sigma * measured.late_sigma;
  // What the lateness adds to the measured place it takes from the state.
  filter.P_x_late[0] = -filter.P_late * measured.v_BO_held;
  filter.accepted = 1;
  filter.stamp_ns = measured.stamp_ns;
  filter.x[0] = measured.p_BO;
  filter.P[0][0] = measured.cov_B + filter.P_late * measured.v_BO_held * measured.v_BO_held.transpose();
  filter.P[1][1] = Mat3::Identity() * (kStartSpeedSigma * kStartSpeedSigma);
  filter.P[2][2] = Mat3::Identity() * (kStartAccelerationSigma * kStartAccelerationSigma);
  // So does the unknown velocity what it adds.
  filter.P[0][1] = -measured.shift_by_v_B * filter.P[1][1];
  filter.P[1][0] = filter.P[0][1].transpose();
  filter.P[0][0] -= filter.P[0][1] * measured.shift_by_v_B.transpose();
}

// Predicts the estimate over `dt` [s]: x' = F x, P' = F P F^T + Q, with jerk of spectral density q [m^2/s^5].
void Advance(const config::PredictConfig& config, double dt, TargetFilter& filter) noexcept {
  const double F[kOrder][kOrder] = {{1.0, dt, 0.5 * dt * dt}, {0.0, 1.0, dt}, {0.0, 0.0, 1.0}};
  const double q = config.target_jerk * config.target_jerk * kJerkTime;
  const double dt2 = dt * dt;
  const double dt3 = dt2 * dt;
  const double Q[kOrder][kOrder] = {{q * dt3 * dt2 / 20.0, q * dt2 * dt2 / 8.0, q * dt3 / 6.0},
                                    {q * dt2 * dt2 / 8.0, q * dt3 / 3.0, q * dt2 / 2.0},
                                    {q * dt3 / 6.0, q * dt2 / 2.0, q * dt}};
  const TargetFilter before = filter;
  for (std::size_t i = 0; i < kOrder; ++i) {
    filter.x[i].setZero();
    for (std::size_t k = i; k < kOrder; ++k) {
      filter.x[i] += F[i][k] * before.x[k];
    }
    for (std::size_t j = 0; j < kOrder; ++j) {
      Mat3 sum = Mat3::Identity() * Q[i][j];
      for (std::size_t k = i; k < kOrder; ++k) {
        for (std::size_t l = j; l < kOrder; ++l) {
          sum += (F[i][k] * F[j][l]) * before.P[k][l];
        }
      }
      filter.P[i][j] = sum;
    }
    filter.P_x_late[i].setZero();
    for (std::size_t k = i; k < kOrder; ++k) {
      filter.P_x_late[i] += F[i][k] * before.P_x_late[k];
    }
  }
  filter.P_late = DriftedVariance(filter.P_late, dt, config.stamp_sigma);
}

}  // namespace

TargetFilter::TargetFilter() noexcept {
  for (std::size_t i = 0; i < kOrder; ++i) {
    x[i].setZero();
    P_x_late[i].setZero();
    for (std::size_t j = 0; j < kOrder; ++j) {
      P[i][j].setZero();
    }
  }
}

hal::Intake Update(const config::PredictConfig& config, const MeasuredCentre& measured,
                   TargetFilter& filter) noexcept {
  if (filter.accepted == 0) {
    StartAt(measured, filter);
    return hal::Intake::kTaken;
  }
  if (measured.stamp_ns <= filter.stamp_ns) {
    return hal::Intake::kTooOld;
  }
  TargetFilter next = filter;
  Advance(config, hal::ToSeconds(measured.stamp_ns - filter.stamp_ns), next);

  // The state is that of the shown target. Its measured place also depends on where the camera was: with an
  // error in `late`, it seems to have moved with the camera. And on its velocity, under a rolling shutter.
  const Mat3& D = measured.shift_by_v_B;
  const Vec3 innovation =
      measured.p_BO - next.x[0] - (next.late - measured.late) * measured.v_BO_held - D * next.x[1];
  std::array<Mat3, kOrder> P_xz;  // the covariance of the state and the place
  for (std::size_t i = 0; i < kOrder; ++i) {
    P_xz[i] = next.P[i][0] + next.P_x_late[i] * measured.v_BO_held.transpose() + next.P[i][1] * D.transpose();
  }
  const Vec3 P_late_z = next.P_x_late[0] + next.P_late * measured.v_BO_held + D * next.P_x_late[1];
  const Mat3 S = P_xz[0] + measured.v_BO_held * P_late_z.transpose() + D * P_xz[1] + measured.cov_B;
  const Mat3 S_inverse = S.inverse();
  const double gate2 = config.gate_sigma * config.gate_sigma;
  const auto fits = [&](const Mat3& inverse) { return innovation.dot(inverse * innovation) <= gate2; };
  const auto fits_with_doubt = [&] {
    return measured.doubt != nullptr && fits((S + measured.doubt->OfPlace(measured.p_CO_C)).inverse());
  };
  if (!fits(S_inverse) && !fits_with_doubt()) {
    if (filter.rejected_in_row + 1 >= config.gate_rejects_max) {
      StartAt(measured, filter);
      return hal::Intake::kTaken;
    }
    ++filter.rejected_in_row;
    return hal::Intake::kOutlier;
  }
  std::array<Mat3, kOrder> K;
  for (std::size_t i = 0; i < kOrder; ++i) {
    K[i] = P_xz[i] * S_inverse;
    next.x[i] += K[i] * innovation;
  }
  const Vec3 K_late = S_inverse * P_late_z;
  next.late += K_late.dot(innovation);
  for (std::size_t i = 0; i < kOrder; ++i) {
    for (std::size_t j = i; j < kOrder; ++j) {
      next.P[i][j] -= K[i] * P_xz[j].transpose();
      // Keeps the covariance symmetric over hours of rounding.
      if (i == j) {
        next.P[i][i] = 0.5 * (next.P[i][i] + next.P[i][i].transpose()).eval();
      } else {
        next.P[j][i] = next.P[i][j].transpose();
      }
    }
    next.P_x_late[i] -= K[i] * P_late_z;
  }
  next.P_late = std::max(next.P_late - K_late.dot(P_late_z), 0.0);
  next.late = CredibleLateness(next.late, config.stamp_offset, config.stamp_sigma);
  next.x[1] = Shortened(next.x[1], config.target_speed_max);
  next.x[2] = Shortened(next.x[2], config.target_acceleration_max);
  next.stamp_ns = measured.stamp_ns;
  next.rejected_in_row = 0;
  if (next.accepted < config.accepted_min) {
    ++next.accepted;
  }
  filter = next;
  return hal::Intake::kTaken;
}

TargetMotion MotionAt(const config::PredictConfig& config, const TargetFilter& filter,
                      std::int64_t now_ns) noexcept {
  const double dt = hal::ToSeconds(now_ns - filter.stamp_ns) + filter.late;
  const Vec3 way = dt * (filter.x[1] + 0.5 * dt * filter.x[2]);
  return {filter.x[0] + Shortened(way, config.target_speed_max * std::fabs(dt)),
          Shortened(filter.x[1] + dt * filter.x[2], config.target_speed_max)};
}

}  // namespace fovea::estimate
