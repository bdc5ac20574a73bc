#include "firmware/core/barriers/line_of_sight_barrier.hpp"

#include <cmath>

#include "firmware/core/model/segments.hpp"

namespace fovea::barriers {
namespace {

using model::Vec3;

constexpr int kHandJoints = 2;  // the last ones carry the camera: what lies between them is not in its way

// Where a line of sight and a link's line are nearest to each other.
struct Nearest {
  model::SegmentPair pair;   // the line of sight from the camera, the link's from its joint
  int joint = -1;            // that carries the link; -1: the base
  Vec3 p_BP = Vec3::Zero();  // the target's point that is looked at [m]
};

// Of all links and all lines of sight.
Nearest NearestLink(const model::ArmModel& arm, const Sight& sight) noexcept {
  const ArmLine& line = sight.line;
  Nearest nearest;
  for (std::size_t k = 0; k < static_cast<std::size_t>(sight.outline.num_points); ++k) {
    const Vec3 p_BP = sight.X_BO * sight.outline.p_OP[k];
    for (std::size_t i = 0; line.joint[i] + 1 < arm.num_joints - kHandJoints; ++i) {
      const model::SegmentPair pair =
          model::NearestOfSegments(sight.X_BC.p, p_BP, line.p_B[i], line.p_B[i + 1]);
      if (pair.distance < nearest.pair.distance) {
        nearest = {pair, line.joint[i], p_BP};
      }
    }
  }
  return nearest;
}

}  // namespace

double ClearanceOfSight(const model::ArmModel& arm, const Sight& sight) noexcept {
  return NearestLink(arm, sight).pair.distance;
}

Barrier LineOfSightBarrier(const config::ServoConfig& config, const Sight& sight,
                           const model::Mat6N& J_C) noexcept {
  constexpr double kTouch = 1e-6;  // lines that cross have no direction apart [m]
  Barrier barrier;
  if (config.guard.sight_clearance <= 0.0) {
    return barrier;
  }
  const Nearest nearest = NearestLink(config.arm, sight);
  const model::SegmentPair& pair = nearest.pair;
  if (!(pair.distance > kTouch) || !std::isfinite(pair.distance)) {
    return barrier;
  }
  const Vec3 apart = (pair.on_first - pair.on_second) / pair.distance;
  // d/dt distance = apart . (v_sight - v_link); the line of sight turns about the target, which stays.
  const Vec3 apart_C = sight.X_BC.R.transpose() * apart;
  barrier.gradient = (1.0 - pair.s) * J_C.topRows<3>().transpose().lazyProduct(apart_C);
  model::LinearJacobian J_link;
  model::ComputeLinearJacobian(config.arm, sight.poses, pair.on_second, J_link);
  for (int i = 0; i <= nearest.joint; ++i) {
    barrier.gradient[i] -= J_link.col(i).dot(apart);
  }
  barrier.name = hal::Limit::kFieldOfView;
  barrier.value = pair.distance;
  barrier.margin = config.guard.sight_clearance;
  barrier.rate = config.guard.barrier_rate;
  return barrier;
}

}  // namespace fovea::barriers
