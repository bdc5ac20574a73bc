// SPDX-License-Identifier: Apache-2.0
#include "firmware/planning/time_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::planning {
namespace {

constexpr double kShare = 0.95;        // of the guard's limits
constexpr int kSamples = 16;           // in the mean
constexpr double kLeastPeriod = 0.02;  // between control points [s]

// The length of the mean [s].
double WindowOf(const JointLimits& limits, int num_joints) noexcept {
  double window = 0.0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(num_joints); ++i) {
    window = std::max(window, 2.0 * limits[i].a_max / limits[i].j_max);
  }
  return window;
}

void Append(const model::VecN& q, trajectory::Plan& plan) noexcept {
  for (int i = 0; i < plan.num_joints; ++i) {
    plan.points[static_cast<std::size_t>(plan.num_points * plan.num_joints + i)] = q[i];
  }
  ++plan.num_points;
}

}  // namespace

JointLimits LimitsOfPlan(const config::ServoConfig& config) noexcept {
  JointLimits limits;
  for (int i = 0; i < config.arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const trajectory::JointPace pace = trajectory::PaceOf(config, i);
    limits[k] = {kShare * config.guard.joint_velocity_fraction * config.arm.joints[k].dq_max,
                 kShare * pace.ddq_max, kShare * pace.dddq_max};
  }
  return limits;
}

double LagOf(const JointLimits& limits, int num_joints, double period_s) noexcept {
  return period_s + 0.5 * WindowOf(limits, num_joints);
}

void TimePath(const SmoothPath& path, const PathSpeed& speed, double duration_s, const JointLimits& limits,
              trajectory::Plan& plan) noexcept {
  const double sample_s = WindowOf(limits, plan.num_joints) / kSamples;
  // Two points before the motion and two after it are at rest, and one is for rounding.
  const double room = trajectory::Plan::Capacity(plan.num_joints) - 6;
  const double least = std::max((duration_s + kSamples * sample_s) / room, kLeastPeriod);
  const int stride = static_cast<int>(std::ceil(least / sample_s));
  const int rest = static_cast<int>(std::ceil(duration_s / sample_s)) + kSamples;  // all samples are the end
  const int last = (rest + stride - 1) / stride * stride;
  plan.period_s = stride * sample_s;
  plan.num_points = 0;
  const model::VecN first = path.At(0.0);
  Append(first, plan);
  Append(first, plan);
  // The mean of the newest samples, in a ring. Before the start, all are `first`.
  std::array<model::VecN, kSamples> ring;
  ring.fill(first);
  std::size_t cell = 0;
  for (int sample = 0; sample <= last; ++sample) {
    ring[static_cast<std::size_t>(sample % kSamples)] = path.At(speed.UAt(sample * sample_s, cell));
    if (sample % stride == 0) {
      // Relative to the first, so that the mean of equal samples is exactly that sample.
      model::VecN mean = model::VecN::Zero(first.size());
      for (const model::VecN& q : ring) {
        mean += q - ring[0];
      }
      Append(ring[0] + mean / kSamples, plan);
    }
  }
  const model::VecN end = path.At(path.End());
  Append(end, plan);
  Append(end, plan);
}

}  // namespace fovea::planning
