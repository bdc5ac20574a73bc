#include "fovea/servo/keep_apart.hpp"

#include <algorithm>
#include <cmath>

#include "fovea/servo/obstacle.hpp"
#include "fovea/servo/segments.hpp"

namespace fovea::servo {
namespace {

using model::Vec3;

constexpr int kTrunkJoints = 3;    // the base's line to the first joint, and on to the third, at the elbow
constexpr int kForearmJoints = 4;  // the last ones: the elbow's, and the wrist's three
constexpr int kJointsLeast = 6;    // fewer, and there is no such hand
constexpr double kRate = 1.5;      // what is left may be used up no faster than exp(-rate t) [1/s]

struct Nearest {
  SegmentPair pair;  // the hand's line from the last joint, the trunk's from its joint
  int joint = -1;    // that carries the trunk's link; -1: the base
};

Nearest NearestTrunk(const model::ArmModel& arm, const ArmLine& line) noexcept {
  Nearest nearest;
  if (arm.num_joints < kJointsLeast) {
    return nearest;
  }
  const auto last = static_cast<std::size_t>(line.num_points - 1);
  std::size_t from = last;  // where the last link's line begins
  while (line.joint[from - 1] == arm.num_joints - 1) {
    --from;
  }
  const Vec3& wrist = line.p_B[from];
  for (std::size_t i = 0; line.joint[i] + 1 < kTrunkJoints; ++i) {
    const SegmentPair pair = NearestOfSegments(wrist, line.p_B[last], line.p_B[i], line.p_B[i + 1]);
    if (pair.distance < nearest.pair.distance) {
      nearest = {pair, line.joint[i]};
    }
  }
  return nearest;
}

// Where the arm's line from the elbow on is nearest to a plane.
struct NearestPlane {
  Clearance clearance{HUGE_VAL, Vec3::UnitZ()};
  Vec3 p_BP = Vec3::Zero();  // the line's point [m]
  int joint = -1;            // that carries it
};

NearestPlane NearestOfPlanes(const model::ArmModel& arm, const Obstacles& obstacles,
                             const ArmLine& line) noexcept {
  NearestPlane nearest;
  for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(line.num_points); ++k) {  // but the end effector
    for (int i = 0; i < obstacles.num_planes && line.joint[k] >= arm.num_joints - kForearmJoints; ++i) {
      const Clearance clearance = ClearanceOf(obstacles, i, line.p_B[k]);
      if (clearance.distance < nearest.clearance.distance) {
        nearest = {clearance, line.p_B[k], line.joint[k]};
      }
    }
  }
  return nearest;
}

}  // namespace

double ClearanceOfHand(const model::ArmModel& arm, const ArmLine& line) noexcept {
  return NearestTrunk(arm, line).pair.distance;
}

void LimitHand(double clearance, const model::ArmModel& arm, const model::ArmPoses& poses,
               const ArmLine& line, MotionLimits& limits) noexcept {
  constexpr double kTouch = 1e-6;  // lines that cross have no direction apart [m]
  if (clearance <= 0.0) {
    return;
  }
  const Nearest nearest = NearestTrunk(arm, line);
  if (!(nearest.pair.distance > kTouch) || !std::isfinite(nearest.pair.distance)) {
    return;
  }
  // d/dt distance = apart . (v_hand - v_trunk).
  const Vec3 apart = (nearest.pair.on_first - nearest.pair.on_second) / nearest.pair.distance;
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, nearest.pair.on_first, J);
  model::VecN gradient = J.transpose().lazyProduct(apart);
  model::ComputeLinearJacobian(arm, poses, nearest.pair.on_second, J);
  for (int i = 0; i <= nearest.joint; ++i) {
    gradient[i] -= J.col(i).dot(apart);
  }
  limits.AddRow(-gradient, std::max(kRate * (nearest.pair.distance - clearance), 0.0));
}

double ClearanceOfPlanes(const model::ArmModel& arm, const Obstacles& obstacles,
                         const ArmLine& line) noexcept {
  return NearestOfPlanes(arm, obstacles, line).clearance.distance;
}

void LimitArm(const model::ArmModel& arm, const Obstacles& obstacles, const model::ArmPoses& poses,
              const ArmLine& line, MotionLimits& limits) noexcept {
  const NearestPlane nearest = NearestOfPlanes(arm, obstacles, line);
  if (!std::isfinite(nearest.clearance.distance)) {
    return;
  }
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, nearest.p_BP, J);
  model::VecN gradient = model::VecN::Zero(arm.num_joints);
  for (int i = 0; i <= nearest.joint; ++i) {
    gradient[i] = J.col(i).dot(nearest.clearance.away);
  }
  limits.AddRow(-gradient, std::max(kRate * nearest.clearance.distance, 0.0));
}

}  // namespace fovea::servo
