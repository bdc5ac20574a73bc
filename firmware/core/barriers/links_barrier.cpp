#include "firmware/core/barriers/links_barrier.hpp"

#include <cmath>

#include "firmware/core/barriers/obstacle.hpp"
#include "firmware/core/trajectory/joint_pace.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

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

double ClearanceOfPlanes(const model::ArmModel& arm, const config::GuardConfig& guard,
                         const ArmLine& line) noexcept {
  return NearestOfPlanes(arm, guard, line).clearance.distance;
}

Barrier LinksBarrier(const config::ServoConfig& config, const model::ArmPoses& poses,
                     const ArmLine& line) noexcept {
  const model::ArmModel& arm = config.arm;
  const NearestPlane nearest = NearestOfPlanes(arm, config.guard, line);
  Barrier barrier;
  if (!std::isfinite(nearest.clearance.distance)) {
    return barrier;
  }
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, nearest.p_BP, J);
  barrier.gradient = model::VecN::Zero(arm.num_joints);
  for (int i = 0; i <= nearest.joint; ++i) {
    barrier.gradient[i] = J.col(i).dot(nearest.clearance.away);
  }
  barrier.name = hal::Limit::kObstacle;
  barrier.value = nearest.clearance.distance;
  barrier.margin = 2.0 * config.guard.workspace_margin;
  barrier.deceleration = 0.5 * config.guard.workspace_deceleration;
  barrier.reaction_s = trajectory::SlowestReaction(config);
  return barrier;
}

}  // namespace fovea::barriers
