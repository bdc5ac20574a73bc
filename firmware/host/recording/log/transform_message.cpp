// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/transform_message.hpp"

#include <Eigen/Geometry>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/recording/log/stamp.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "foxglove/geometry.pb.h"

namespace fovea::log {
namespace {

void SetPosition(const model::Vec3& p, foxglove::Vector3& to) {
  to.set_x(p.x());
  to.set_y(p.y());
  to.set_z(p.z());
}

void SetRotation(const model::Mat3& R, foxglove::Quaternion& to) {
  const Eigen::Quaterniond q(R);
  to.set_w(q.w());
  to.set_x(q.x());
  to.set_y(q.y());
  to.set_z(q.z());
}

}  // namespace

void SetTransforms(std::int64_t stamp_ns, const model::ArmModel& arm, const std::vector<LinkFrame>& frames,
                   const model::VecN& q, const std::optional<model::Pose>& X_BO,
                   foxglove::FrameTransforms& message) {
  model::ArmPoses poses;
  model::ComputePoses(arm, q, poses);
  message.clear_transforms();
  const auto add = [&](const std::string& name, const model::Pose& X_BF) {
    foxglove::FrameTransform& transform = *message.add_transforms();
    SetStamp(stamp_ns, *transform.mutable_timestamp());
    transform.set_parent_frame_id(kBaseFrame);
    transform.set_child_frame_id(name);
    SetPosition(X_BF.p, *transform.mutable_translation());
    SetRotation(X_BF.R, *transform.mutable_rotation());
  };
  for (const LinkFrame& frame : frames) {
    const model::Pose X_BL =
        frame.joint < 0 ? model::Pose{} : poses.X_BL[static_cast<std::size_t>(frame.joint)];
    add(frame.name, X_BL * frame.X_LnF);
  }
  if (X_BO) {
    add(kTargetFrame, *X_BO);
  }
}

}  // namespace fovea::log
