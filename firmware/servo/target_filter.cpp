#include "fovea/servo/target_filter.hpp"

#include <Eigen/LU>  // inverse of a 3x3

namespace fovea::servo {
namespace {

constexpr double kStartSpeedSigma = 0.3;  // how fast a target may be when it is first seen [m/s]

double Seconds(std::int64_t duration_ns) noexcept { return static_cast<double>(duration_ns) * 1e-9; }

void StartAt(std::int64_t stamp_ns, const model::Vec3& p_BO, const model::Mat3& cov_B,
             TargetFilter& filter) noexcept {
  filter = TargetFilter{};
  filter.accepted = 1;
  filter.stamp_ns = stamp_ns;
  filter.p_BO = p_BO;
  filter.P_pp = cov_B;
  filter.P_vv = model::Mat3::Identity() * (kStartSpeedSigma * kStartSpeedSigma);
}

// Moves the estimate on by `dt` [s] under an acceleration that is constant within the step, of standard
// deviation `acceleration` [m/s^2].
void Advance(double dt, double acceleration, TargetFilter& filter) noexcept {
  const double a2 = acceleration * acceleration;
  filter.p_BO += dt * filter.v_BO;
  filter.P_pp += dt * (filter.P_pv + filter.P_pv.transpose()) + dt * dt * filter.P_vv;
  filter.P_pv += dt * filter.P_vv;
  filter.P_pp.diagonal().array() += a2 * dt * dt * dt * dt / 4.0;
  filter.P_pv.diagonal().array() += a2 * dt * dt * dt / 2.0;
  filter.P_vv.diagonal().array() += a2 * dt * dt;
}

}  // namespace

void Update(const PredictConfig& config, std::int64_t stamp_ns, const model::Vec3& p_BO,
            const model::Mat3& cov_B, TargetFilter& filter) noexcept {
  if (filter.accepted == 0) {
    StartAt(stamp_ns, p_BO, cov_B, filter);
    return;
  }
  if (stamp_ns <= filter.stamp_ns) {
    return;  // no news
  }
  TargetFilter next = filter;
  Advance(Seconds(stamp_ns - filter.stamp_ns), config.target_acceleration, next);

  const model::Vec3 innovation = p_BO - next.p_BO;
  const model::Mat3 S = next.P_pp + cov_B;
  const model::Mat3 S_inverse = S.inverse();
  const double distance2 = innovation.dot(S_inverse * innovation);
  if (!(distance2 <= config.gate_sigma * config.gate_sigma)) {
    if (filter.rejected_in_row + 1 >= config.gate_rejects_max) {
      StartAt(stamp_ns, p_BO, cov_B, filter);
    } else {
      ++filter.rejected_in_row;
    }
    return;
  }
  const model::Mat3 K_p = next.P_pp * S_inverse;
  const model::Mat3 K_v = next.P_pv.transpose() * S_inverse;
  next.p_BO += K_p * innovation;
  next.v_BO += K_v * innovation;
  next.P_vv -= K_v * S * K_v.transpose();
  next.P_pv -= K_p * S * K_v.transpose();
  next.P_pp -= K_p * S * K_p.transpose();
  // Rounding must not make the covariance lean to one side over hours.
  next.P_pp = 0.5 * (next.P_pp + next.P_pp.transpose()).eval();
  next.P_vv = 0.5 * (next.P_vv + next.P_vv.transpose()).eval();
  next.stamp_ns = stamp_ns;
  next.rejected_in_row = 0;
  if (next.accepted < config.accepted_min) {
    ++next.accepted;
  }
  filter = next;
}

model::Vec3 PositionAt(const TargetFilter& filter, std::int64_t now_ns) noexcept {
  return filter.p_BO + Seconds(now_ns - filter.stamp_ns) * filter.v_BO;
}

}  // namespace fovea::servo
