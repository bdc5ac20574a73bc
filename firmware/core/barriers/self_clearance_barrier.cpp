#include "firmware/core/barriers/self_clearance_barrier.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/barriers/barrier_speed.hpp"
#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/barriers/segments.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

constexpr int kTrunkJoints = 3;    // the base's line to the first joint, and on to the third, at the elbow
constexpr int kForearmJoints = 4;  // the last ones: the elbow's, and the wrist's three
constexpr int kJointsLeast = 6;    // fewer, and there is no such hand
constexpr double kRate = 1.5;      // what is left may be used up no faster than exp(-rate t) [1/s]

constexpr int kBaseJoints = 1;     // the base's line, and the first link's
constexpr double kThicker = 0.05;  // forearm and base are thicker than hand and upper arm by so much [m]

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
      Compare(line, i, k, is_hand ? 0.0 : kThicker, nearest);
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

NearestPlane NearestOfPlanes(const model::ArmModel& arm, const config::GuardConfig& guard,
                             const ArmLine& line) noexcept {
  const config::Obstacles& obstacles = guard.obstacles;
  NearestPlane nearest;
  for (std::size_t k = 0; k + 1 < static_cast<std::size_t>(line.num_points); ++k) {  // but the end effector
    for (int i = 0; i < obstacles.num_planes && line.joint[k] >= arm.num_joints - kForearmJoints; ++i) {
      Clearance clearance = ClearanceOf(obstacles, i, line.p_B[k]);
      clearance.distance -= guard.link_radius;
      if (clearance.distance < nearest.clearance.distance) {
        nearest = {clearance, line.p_B[k], line.joint[k]};
      }
    }
  }
  return nearest;
}

}  // namespace

double ClearanceOfHand(const model::ArmModel& arm, const ArmLine& line) noexcept {
  return NearestTrunk(arm, line).distance;
}

void LimitHand(double clearance, const model::ArmModel& arm, const model::ArmPoses& poses,
               const ArmLine& line, MotionLimits& limits) noexcept {
  constexpr double kTouch = 1e-6;  // lines that cross have no direction apart [m]
  if (clearance <= 0.0) {
    return;
  }
  const Nearest nearest = NearestTrunk(arm, line);
  if (!(nearest.pair.distance > kTouch) || !std::isfinite(nearest.distance)) {
    return;
  }
  // d/dt distance = apart . (v_first - v_second).
  const Vec3 apart = (nearest.pair.on_first - nearest.pair.on_second) / nearest.pair.distance;
  model::VecN gradient = model::VecN::Zero(arm.num_joints);
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, nearest.pair.on_first, J);
  for (int i = 0; i <= nearest.first_joint; ++i) {
    gradient[i] = J.col(i).dot(apart);
  }
  model::ComputeLinearJacobian(arm, poses, nearest.pair.on_second, J);
  for (int i = 0; i <= nearest.second_joint; ++i) {
    gradient[i] -= J.col(i).dot(apart);
  }
  limits.AddRow(-gradient, std::max(kRate * (nearest.distance - clearance), 0.0));
}

double ClearanceOfPlanes(const model::ArmModel& arm, const config::GuardConfig& guard,
                         const ArmLine& line) noexcept {
  return NearestOfPlanes(arm, guard, line).clearance.distance;
}

double ClearanceOfArm(const config::ServoConfig& config, const model::ArmPoses& poses) noexcept {
  const config::GuardConfig& guard = config.guard;
  double clearance = ClearanceOfPlanes(config.arm, guard, LineOfArm(config.arm, poses));
  for (int i = 0; i < CountObstacles(guard.obstacles); ++i) {
    clearance =
        std::min(clearance, ClearanceOf(guard.obstacles, i, guard.hand, poses.X_BE).clearance.distance);
  }
  return clearance;
}

void LimitArm(const config::ServoConfig& config, const model::ArmPoses& poses, const ArmLine& line,
              MotionLimits& limits) noexcept {
  const model::ArmModel& arm = config.arm;
  const NearestPlane nearest = NearestOfPlanes(arm, config.guard, line);
  if (!std::isfinite(nearest.clearance.distance)) {
    return;
  }
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, nearest.p_BP, J);
  model::VecN gradient = model::VecN::Zero(arm.num_joints);
  for (int i = 0; i <= nearest.joint; ++i) {
    gradient[i] = J.col(i).dot(nearest.clearance.away);
  }
  const double room = nearest.clearance.distance - 2.0 * config.guard.workspace_margin;
  limits.AddRow(-gradient, BarrierSpeed(room, 0.5 * config.guard.workspace_deceleration,
                                        trajectory::SlowestReaction(config)));
}

}  // namespace fovea::barriers
