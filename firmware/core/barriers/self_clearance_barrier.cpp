#include "firmware/core/barriers/self_clearance_barrier.hpp"

#include <cmath>

#include "firmware/core/barriers/segments.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

constexpr int kTrunkJoints = 3;  // the base's line to the first joint, and on to the third, at the elbow
constexpr int kJointsLeast = 6;  // fewer, and there is no such hand
constexpr int kBaseJoints = 1;   // the base's line, and the first link's
// Thicker than hand and upper arm by so much [m]: the base, and forearm and base together.
constexpr double kThickerBase = 0.02;
constexpr double kThickerForearm = 0.05;

struct Nearest {
  SegmentPair pair;  // first of what moves more
  double distance = HUGE_VAL;
  int first_joint = -1;   // that carries the first line
  int second_joint = -1;  // and the second; -1: the base
};

// Takes lines `i` and `k` where they are nearer than what was, `thicker` [m] taken off.
void Compare(const ArmLine& line, std::size_t i, std::size_t k, double thicker, Nearest& nearest) noexcept {
  const SegmentPair pair = NearestOfSegments(line.p_B[i], line.p_B[i + 1], line.p_B[k], line.p_B[k + 1]);
  if (pair.distance - thicker < nearest.distance) {
    nearest = {pair, pair.distance - thicker, line.joint[i], line.joint[k]};
  }
}

// The hand against the trunk, and the forearm against the base.
Nearest NearestTrunk(const model::ArmModel& arm, const ArmLine& line) noexcept {
  Nearest nearest;
  if (arm.num_joints < kJointsLeast) {
    return nearest;
  }
  const auto last = static_cast<std::size_t>(line.num_points - 1);
  for (std::size_t i = 0; i < last; ++i) {
    const int joint = line.joint[i];
    const bool is_hand = joint == arm.num_joints - 1;
    if (joint < arm.num_joints - kForearmJoints) {
      continue;
    }
    const int most = is_hand ? kTrunkJoints : kBaseJoints + 1;
    for (std::size_t k = 0; line.joint[k] + 1 < most; ++k) {
      const double thicker_hand = line.joint[k] < 0 ? kThickerBase : 0.0;
      Compare(line, i, k, is_hand ? thicker_hand : kThickerForearm, nearest);
    }
  }
  return nearest;
}

}  // namespace

double ClearanceOfHand(const model::ArmModel& arm, const ArmLine& line) noexcept {
  return NearestTrunk(arm, line).distance;
}

Barrier SelfClearanceBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                             const ArmLine& line) noexcept {
  constexpr double kTouch = 1e-6;  // lines that cross have no direction apart [m]
  const model::ArmModel& arm = config.arm;
  Barrier barrier;
  if (config.guard.hand_clearance <= 0.0) {
    return barrier;
  }
  const Nearest nearest = NearestTrunk(arm, line);
  if (!(nearest.pair.distance > kTouch) || !std::isfinite(nearest.distance)) {
    return barrier;
  }
  // d/dt distance = apart . (v_first - v_second).
  const Vec3 apart = (nearest.pair.on_first - nearest.pair.on_second) / nearest.pair.distance;
  barrier.gradient = model::VecN::Zero(arm.num_joints);
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, nearest.pair.on_first, J);
  for (int i = 0; i <= nearest.first_joint; ++i) {
    barrier.gradient[i] = J.col(i).dot(apart);
  }
  model::ComputeLinearJacobian(arm, poses, nearest.pair.on_second, J);
  for (int i = 0; i <= nearest.second_joint; ++i) {
    barrier.gradient[i] -= J.col(i).dot(apart);
  }
  barrier.name = hal::Limit::kObstacle;
  barrier.value = nearest.distance;
  barrier.margin = config.guard.hand_clearance;
  barrier.rate = config.guard.barrier_rate;
  return barrier;
}

}  // namespace fovea::barriers
