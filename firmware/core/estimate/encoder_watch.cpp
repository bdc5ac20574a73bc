// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/encoder_watch.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/model/cholesky.hpp"

namespace fovea::estimate {
namespace {

constexpr double kMeanShare = hal::kTickPeriodS / 0.05;  // the mean forgets in 0.05 s
constexpr double kQuanta = 3.0;                          // encoder steps that a joint must have moved by
constexpr double kTorqueShare = 0.01;                    // of a joint's torque: short-term error of the model
constexpr double kWishSlack = 0.01;                      // lag of the joint behind its reference [rad, m]
constexpr double kLeast = 1e-9;                          // if the encoder has no steps [rad, m]
constexpr double kTravelSlack = 1e-3;                    // largest integral of velocity noise [rad, m]
constexpr double kShown = 0.5;              // share of the expected speed change that proves a live encoder
constexpr double kFlicker = 1e-6;           // velocity noise is larger than this [rad/s, m/s]
constexpr std::int32_t kFlickersMost = 30;  // this many make a joint noisy: about a tenth of a second
constexpr std::int32_t kTicksMost = 1'000'000;  // counters stop here
constexpr std::int32_t kNoiseTicks = 200;       // the noise of a velocity is a mean over so many ticks
constexpr double kNoiseSigmas = 6.0;  // what a velocity's noise may come to, in its standard deviations

// Accelerations that the readings do not show, from the change of each external torque against its mean. Zero
// if friction may hold the joint. (If encoder i hangs and joint i moves by ddq, the observer sees -M e_i
// ddq.)
void UnseenAcceleration(const config::ServoConfig& config, const WatchedJoints& now, EncoderWatch& watch,
                        hal::JointArray& ddq) noexcept {
  const int n = config.arm.num_joints;
  const double gain = config.safety.contact_gain * hal::kTickPeriodS;
  model::VecN change = model::VecN::Zero(n);
  hal::JointArray share{};  // of the change that friction cannot hold
  bool any = false;
  for (int i = 0; now.drives && i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& arm_joint = config.arm.joints[k];
    EncoderWatch::Joint& joint = watch.joints[k];
    // The observer approaches the torque with a known time constant. This is its final value.
    const double pushed = now.residual[i] + (watch.drove ? (now.residual[i] - joint.residual) / gain : 0.0);
    joint.residual = now.residual[i];
    change[i] = joint.mean - pushed;
    joint.mean += kMeanShare * (pushed - joint.mean);
    const double free =
        config.safety.stiction_fraction * arm_joint.coulomb + kTorqueShare * arm_joint.tau_max;
    share[k] = std::max(1.0 - free / std::max(std::fabs(change[i]), kLeast), 0.0);
    any = any || share[k] > 0.0;
  }
  ddq = {};
  if (!any) {
    return;
  }
  model::MatN M = now.dynamics.M;
  model::FactorCholesky(M);
  model::SolveCholesky(M, change);
  for (int i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    ddq[k] = share[k] * change[i];
  }
}

// True if a push on the joint began or ended and the measured velocity shows it: the joint reverses within
// one encoder step. On a live encoder the push's effect is opposite to the unseen motion of a hanging one.
bool TurnsRound(const EncoderWatch::Joint& joint, double dq) noexcept {
  return (joint.dq - dq) * joint.speed >= kShown * joint.speed * joint.speed;
}

// White noise n of dq makes two changes in a row n1 - n0, n2 - n1: the mean of their product is -sigma^2. A
// motion that accelerates makes it larger. A reading that has stopped tells nothing.
void LearnNoise(double change, EncoderWatch::Joint& joint) noexcept {
  if (change == 0.0) {
    return;
  }
  joint.noise_ticks = std::min(joint.noise_ticks + 1, kNoiseTicks);
  joint.noise2 += (-change * joint.change_last - joint.noise2) / joint.noise_ticks;
}

// The largest distance that the noise of a joint's velocity seems to move it by.
struct NoiseReach {
  double travel = 0.0;  // the integral of dq
  double way = 0.0;     // that of a speed which begins at one noisy reading
};
NoiseReach ReachOf(const EncoderWatch::Joint& joint) noexcept {
  const double most = kNoiseSigmas * std::sqrt(std::max(joint.noise2, 0.0)) * hal::kTickPeriodS;
  return {most * std::sqrt(static_cast<double>(joint.ticks)), most * joint.unseen_ticks};
}

// True if a joint that flickers has stopped flickering. Only a joint that flickers at rest and never repeats
// a reading there does so from noise. An encoder with steps flickers too, but only in motion or now and then.
bool HasFrozen(const config::ServoConfig& config, double q, double dq, EncoderWatch::Joint& joint) noexcept {
  const double change = dq - joint.dq_last;
  const bool is_up_and_down = change * joint.change_last < -kFlicker * kFlicker;
  const bool same = change == 0.0 && q == joint.q_last;
  const bool rests = joint.ticks > 0 && std::fabs(q - joint.q) <= config.safety.encoder_quantum;
  joint.same_ticks = same ? std::min<std::int32_t>(joint.same_ticks + 1, kTicksMost) : 0;
  if (same) {
    joint.flickers = 0;
  } else if (rests) {
    joint.flickers = std::max<std::int32_t>(joint.flickers + (is_up_and_down ? 1 : -1), 0);
  }
  joint.is_noisy = joint.is_noisy || joint.flickers >= kFlickersMost;
  LearnNoise(change, joint);
  joint.change_last = change != 0.0 ? change : joint.change_last;
  joint.q_last = q;
  joint.dq_last = dq;
  return joint.is_noisy && config.safety.frozen_ticks > 0 && joint.same_ticks >= config.safety.frozen_ticks;
}

}  // namespace

std::int32_t WatchEncoders(const config::ServoConfig& config, const WatchedJoints& now,
                           EncoderWatch& watch) noexcept {
  const double enough = kQuanta * config.safety.encoder_quantum;
  hal::JointArray unseen{};
  UnseenAcceleration(config, now, watch, unseen);
  std::int32_t hangs = -1;
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& arm_joint = config.arm.joints[k];
    EncoderWatch::Joint& joint = watch.joints[k];
    if (HasFrozen(config, now.q[i], now.dq[i], joint) && hangs < 0) {
      hangs = i;
    }
    if (joint.ticks == 0 || std::fabs(now.q[i] - joint.q) > config.safety.encoder_quantum) {
      joint.ticks = 1;
      joint.mean = joint.residual;  // the encoder is alive: the torque until now is explained
      joint.q = now.q[i];
      joint.q_reference = now.q_reference[i];
      joint.dq = now.dq[i];
      joint.speed = joint.way = joint.travel = 0.0;
      joint.unseen_ticks = 0;
      continue;
    }
    if (!watch.drove) {
      joint.q_reference = now.q_reference[i];  // the reference starts here
    }
    joint.ticks = std::min(joint.ticks + 1, kTicksMost);
    joint.travel += now.dq[i] * hal::kTickPeriodS;
    if (unseen[k] != 0.0) {
      joint.speed += unseen[k] * hal::kTickPeriodS;
      joint.way += joint.speed * hal::kTickPeriodS;
      joint.unseen_ticks = std::min(joint.unseen_ticks + 1, kTicksMost);
    } else {
      joint.dq = now.dq[i];
      joint.speed = joint.way = 0.0;
      joint.unseen_ticks = 0;
    }
    const double held = config.safety.stiction_fraction * arm_joint.coulomb;
    const double M = now.dynamics.M(i, i);
    const double omega_n = config.motion_law.omega_n;
    const double wished = now.drives ? std::fabs(now.q_reference[i] - joint.q_reference) : 0.0;
    // The joint has not yet made an allowed step of the reference.
    const double late = std::max(kWishSlack, config.safety.setpoint_jump);
    const NoiseReach noise = ReachOf(joint);
    const double gone =
        std::max({TurnsRound(joint, now.dq[i]) ? 0.0 : std::fabs(joint.way) / (enough + kLeast + noise.way),
                  std::fabs(joint.travel) / (enough + kTravelSlack + noise.travel),
                  wished / (enough + late + held / (M * omega_n * omega_n))});
    if (gone > 1.0 && joint.ticks >= config.safety.non_finite_ticks && hangs < 0) {
      hangs = i;
    }
  }
  watch.drove = now.drives;
  return hangs;
}

}  // namespace fovea::estimate
