// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/barriers/self_clearance_barrier.hpp"

#include <cmath>
#include <span>

#include "firmware/core/model/segments.hpp"

namespace fovea::barriers {
namespace {

using model::ArmShape;
using model::Vec3;

struct NearestBodies {
  model::SegmentPair axes;  // first: of the body further from the base
  double gap = HUGE_VAL;
  ArmShape::Pair pair;
};

NearestBodies NearestPair(const ArmShape& shape, const ArmBodies& bodies) noexcept {
  NearestBodies nearest;
  for (const ArmShape::Pair& pair : std::span(shape.pairs).first(static_cast<std::size_t>(shape.num_pairs))) {
    const PlacedCapsule& far = bodies.body[static_cast<std::size_t>(pair.far)];
    const PlacedCapsule& near = bodies.body[static_cast<std::size_t>(pair.near)];
    // Skips bodies whose bounding balls are further apart than the smallest gap so far.
    const double apart = nearest.gap + far.reach + near.reach;
    if (apart > 0.0 && (far.middle - near.middle).squaredNorm() > apart * apart) {
      continue;
    }
    const model::SegmentPair axes = model::NearestOfSegments(far.p_BA, far.p_BB, near.p_BA, near.p_BB);
    const double gap = axes.distance - far.radius - near.radius;
    if (gap < nearest.gap) {
      nearest = {axes, gap, pair};
    }
  }
  return nearest;
}

}  // namespace

double SelfClearance(const model::ArmModel& arm, const ArmBodies& bodies) noexcept {
  return NearestPair(arm.shape, bodies).gap;
}

Barrier SelfClearanceBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                             const ArmBodies& bodies) noexcept {
  constexpr double kTouch = 1e-6;  // if axes cross, the direction between them is undefined [m]
  const model::ArmModel& arm = config.arm;
  Barrier barrier;
  if (config.guard.self_clearance <= 0.0) {
    return barrier;
  }
  const NearestBodies nearest = NearestPair(arm.shape, bodies);
  if (!std::isfinite(nearest.gap) || !(nearest.axes.distance > kTouch)) {
    return barrier;
  }
  // d/dt gap = apart . (v_first - v_second).
  const Vec3 apart = (nearest.axes.on_first - nearest.axes.on_second) / nearest.axes.distance;
  barrier.gradient = model::VecN::Zero(arm.num_joints);
  for (int i = 0; i < nearest.pair.far; ++i) {
    barrier.gradient[i] = model::PointVelocity(arm, poses, i, nearest.axes.on_first).dot(apart);
  }
  for (int i = 0; i < nearest.pair.near; ++i) {
    barrier.gradient[i] -= model::PointVelocity(arm, poses, i, nearest.axes.on_second).dot(apart);
  }
  barrier.name = hal::Limit::kObstacle;
  barrier.value = nearest.gap;
  barrier.margin = config.guard.self_clearance;
  barrier.rate = config.guard.barrier_rate;
  return barrier;
}

}  // namespace fovea::barriers
