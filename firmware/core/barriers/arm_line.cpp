#include "firmware/core/barriers/arm_line.hpp"

#include <cmath>

namespace fovea::barriers {

ArmLine LineOfArm(const model::ArmModel& arm, const model::ArmPoses& poses) noexcept {
  constexpr double kCorner = 0.01;  // a side step or a way along that is shorter makes none [m]
  ArmLine line;
  const auto add = [&line](const model::Vec3& p_B, int joint) {
    const auto k = static_cast<std::size_t>(line.num_points);
    line.p_B[k] = p_B;
    line.joint[k] = joint;
    ++line.num_points;
  };
  add(model::Vec3::Zero(), -1);
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Pose& X_BL = poses.X_BL[k];
    const bool last = i + 1 == arm.num_joints;
    const model::Vec3& next = last ? arm.X_LnE.p : arm.joints[k + 1].X_PJ.p;
    add(X_BL.p, i);
    if (std::fabs(next.x()) > kCorner && next.tail<2>().squaredNorm() > kCorner * kCorner) {
      add(X_BL.p + next.x() * X_BL.R.col(0), i);
    }
  }
  add(poses.X_BE.p, arm.num_joints - 1);
  return line;
}

}  // namespace fovea::barriers
