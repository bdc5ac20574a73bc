#include "fovea/servo/encoder_watch.hpp"

#include <algorithm>
#include <cmath>

namespace fovea::servo {
namespace {

constexpr double kPeriodS = static_cast<double>(hal::kTickPeriodNs) * 1e-9;
constexpr double kMeanShare = kPeriodS / 0.05;  // the mean forgets in 0.05 s
constexpr double kQuanta = 3.0;                 // a joint that must have gone so many steps of its encoder
constexpr double kTorqueShare = 0.01;           // of its torque: what the model may be wrong by in a moment
constexpr double kWishSlack = 0.01;             // what the law may be late by [rad, m]
constexpr double kLeast = 1e-9;                 // where the encoder has no steps [rad, m]
constexpr double kTravelSlack = 1e-3;           // what noise of the velocities may add up to [rad, m]
constexpr std::int32_t kTicksMost = 1'000'000;  // counted no further

}  // namespace

std::int32_t WatchEncoders(const ServoConfig& config, const WatchedJoints& now,
                           EncoderWatch& watch) noexcept {
  const double enough = kQuanta * config.safety.encoder_quantum;
  std::int32_t hangs = -1;
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& arm_joint = config.arm.joints[k];
    EncoderWatch::Joint& joint = watch.joints[k];
    const double pushed = now.drives ? now.residual[i] : joint.mean;
    const double change = joint.mean - pushed;  // what moves it, less what did
    joint.mean += kMeanShare * (pushed - joint.mean);
    if (joint.ticks == 0 || std::fabs(now.q[i] - joint.q) > config.safety.encoder_quantum) {
      joint = {joint.mean, 1, now.q[i], now.q_reference[i], 0.0, 0.0, 0.0};
      continue;
    }
    if (!watch.drove) {
      joint.q_reference = now.q_reference[i];  // it begins here
    }
    joint.ticks = std::min(joint.ticks + 1, kTicksMost);
    joint.travel += now.dq[i] * kPeriodS;
    const double held = config.safety.stiction_fraction * arm_joint.coulomb;
    const double free = held + kTorqueShare * arm_joint.tau_max;
    const double M = now.dynamics.M(i, i);
    const double excess = std::max(std::fabs(change) - free, 0.0);
    joint.speed = excess > 0.0 ? joint.speed + std::copysign(excess, change) / M * kPeriodS : 0.0;
    joint.way = excess > 0.0 ? joint.way + joint.speed * kPeriodS : 0.0;
    const double omega_n = config.motion_law.omega_n;
    const double wished = now.drives ? std::fabs(now.q_reference[i] - joint.q_reference) : 0.0;
    const double gone =
        std::max({std::fabs(joint.way) / (enough + kLeast), std::fabs(joint.travel) / (enough + kTravelSlack),
                  wished / (enough + kWishSlack + held / (M * omega_n * omega_n))});
    if (gone > 1.0 && joint.ticks >= config.safety.non_finite_ticks && hangs < 0) {
      hangs = i;
    }
  }
  watch.drove = now.drives;
  return hangs;
}

}  // namespace fovea::servo
