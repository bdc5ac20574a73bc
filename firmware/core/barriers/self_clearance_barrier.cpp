#include "firmware/core/barriers/self_clearance_barrier.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "firmware/core/model/segments.hpp"

namespace fovea::barriers {
namespace {

using model::ArmShape;
using model::Vec3;

// A capsule's axis in B [m], and the ball about its middle that holds the capsule.
struct Placed {
  Vec3 a;
  Vec3 b;
  Vec3 middle;
  double reach;
};

struct Nearest {
  model::SegmentPair axes;  // first of the body that is further from the base
  double gap = HUGE_VAL;
  ArmShape::Pair pair;
};

Placed PlaceBody(const model::Capsule& body, const model::Pose& X_BL) noexcept {
  Placed placed;
  placed.a = X_BL * body.p_LA;
  placed.b = X_BL * body.p_LB;
  placed.middle = 0.5 * (placed.a + placed.b);
  placed.reach = 0.5 * (placed.b - placed.a).norm() + body.radius;
  return placed;
}

Nearest NearestPair(const model::ArmModel& arm, const model::ArmPoses& poses) noexcept {
  const ArmShape& shape = arm.shape;
  const std::span<const ArmShape::Pair> pairs =
      std::span(shape.pairs).first(static_cast<std::size_t>(shape.num_pairs));
  std::uint32_t used = 0;  // a bit for each body that is in a pair
  for (const ArmShape::Pair& pair : pairs) {
    used |= (1U << static_cast<unsigned>(pair.near)) | (1U << static_cast<unsigned>(pair.far));
  }
  std::array<Placed, ArmShape::kMostBodies> placed;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(arm.num_joints); ++k) {
    if (((used >> k) & 1U) != 0) {
      placed[k] = PlaceBody(shape.bodies[k], k == 0 ? model::Pose{} : poses.X_BL[k - 1]);
    }
  }
  Nearest nearest;
  for (const ArmShape::Pair& pair : pairs) {
    const auto far = static_cast<std::size_t>(pair.far);
    const auto near = static_cast<std::size_t>(pair.near);
    // Bodies whose balls are further apart than what was found already need no closer look.
    const double apart = nearest.gap + placed[far].reach + placed[near].reach;
    if (apart > 0.0 && (placed[far].middle - placed[near].middle).squaredNorm() > apart * apart) {
      continue;
    }
    const model::SegmentPair axes =
        model::NearestOfSegments(placed[far].a, placed[far].b, placed[near].a, placed[near].b);
    const double gap = axes.distance - shape.bodies[far].radius - shape.bodies[near].radius;
    if (gap < nearest.gap) {
      nearest = {axes, gap, pair};
    }
  }
  return nearest;
}

}  // namespace

double SelfClearance(const model::ArmModel& arm, const model::ArmPoses& poses) noexcept {
  return NearestPair(arm, poses).gap;
}

Barrier SelfClearanceBarrier(const config::ServoConfig& config, const model::ArmPoses& poses) noexcept {
  constexpr double kTouch = 1e-6;  // axes that cross have no direction apart [m]
  const model::ArmModel& arm = config.arm;
  Barrier barrier;
  if (config.guard.self_clearance <= 0.0) {
    return barrier;
  }
  const Nearest nearest = NearestPair(arm, poses);
  if (!std::isfinite(nearest.gap) || !(nearest.axes.distance > kTouch)) {
    return barrier;
  }
  // d/dt gap = apart . (v_first - v_second).
  const Vec3 apart = (nearest.axes.on_first - nearest.axes.on_second) / nearest.axes.distance;
  barrier.gradient = model::VecN::Zero(arm.num_joints);
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, nearest.axes.on_first, J);
  for (int i = 0; i < nearest.pair.far; ++i) {
    barrier.gradient[i] = J.col(i).dot(apart);
  }
  model::ComputeLinearJacobian(arm, poses, nearest.axes.on_second, J);
  for (int i = 0; i < nearest.pair.near; ++i) {
    barrier.gradient[i] -= J.col(i).dot(apart);
  }
  barrier.name = hal::Limit::kObstacle;
  barrier.value = nearest.gap;
  barrier.margin = config.guard.self_clearance;
  barrier.rate = config.guard.barrier_rate;
  return barrier;
}

}  // namespace fovea::barriers
