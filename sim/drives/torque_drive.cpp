// SPDX-License-Identifier: Apache-2.0
#include "sim/drives/torque_drive.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/drives/round_to.hpp"

namespace fovea::sim {

TorqueDrive::TorqueDrive(const TorqueDriveConfig& config) : config_(config) {
  constexpr double kRounding = 1e-9;  // of a tick: 0.003 s are three ticks
  const double ticks = config.delay_s / hal::kTickPeriodS;
  if (!(ticks >= 0.0 && ticks <= kMostDelayTicks + kRounding)) {
    throw std::invalid_argument("TorqueDrive: delay_s is outside 0 to 50 ticks");
  }
  whole_ticks_ = static_cast<std::size_t>(std::floor(ticks + kRounding));
  rest_s_ = std::fmax((ticks - static_cast<double>(whole_ticks_)) * hal::kTickPeriodS, 0.0);
}

double TorqueDrive::Settle(double tau) {
  output_ = RoundTo(tau, config_.quantum);
  commands_.fill(output_);
  return output_;
}

double TorqueDrive::Step(double tau, double q, double dq) {
  newest_ = (newest_ + 1) % commands_.size();
  commands_[newest_] = RoundTo(tau, config_.quantum);
  double impulse = 0.0;
  if (rest_s_ > 0.0) {
    impulse += Lag(Past(whole_ticks_ + 1), rest_s_);
  }
  impulse += Lag(Past(whole_ticks_), hal::kTickPeriodS - rest_s_);
  return impulse / hal::kTickPeriodS + Ripple(q, dq);
}

// The exact answer of T dy/dt = u - y to a constant u.
double TorqueDrive::Lag(double input, double time_s) {
  if (config_.bandwidth_hz == 0.0) {
    output_ = input;
    return input * time_s;
  }
  const double T = 1.0 / (2.0 * std::numbers::pi * config_.bandwidth_hz);
  const double decayed = -std::expm1(-time_s / T);
  const double off = output_ - input;
  output_ -= off * decayed;
  return input * time_s + off * T * decayed;
}

// The mean of a sine over the tick, at constant speed: that of its middle times sin(x) / x.
double TorqueDrive::Ripple(double q, double dq) const {
  if (config_.ripple == 0.0) {
    return 0.0;
  }
  const double half = 0.5 * hal::kTickPeriodS * dq;
  const double x = config_.ripple_cycles * half;
  const double mean = std::fabs(x) > 1e-6 ? std::sin(x) / x : 1.0;
  return config_.ripple * mean * std::sin(config_.ripple_cycles * (q + half) + config_.ripple_phase);
}

double TorqueDrive::Past(std::size_t ticks) const {
  return commands_[(newest_ + commands_.size() - ticks) % commands_.size()];
}

}  // namespace fovea::sim
