// SPDX-License-Identifier: Apache-2.0
#include "firmware/targets/linux/hw_scene.hpp"

#include <Eigen/Geometry>

#include "firmware/host/recording/log/scene_message.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "foxglove/scene.pb.h"

namespace fovea::hw {
namespace {

constexpr double kJointRadius = 0.055;  // [m]
constexpr double kJointLength = 0.12;
constexpr double kRodRadius = 0.04;
constexpr double kShortest = 1e-3;  // shorter rods are not drawn
constexpr double kThickness = 0.001;

Eigen::Isometry3d At(const Eigen::Vector3d& p) { return Eigen::Isometry3d(Eigen::Translation3d(p)); }

// Adds a rod from the entity's origin to `p`.
void AddRod(const Eigen::Vector3d& p, const Eigen::Vector3f& colour, foxglove::SceneEntity& entity) {
  if (p.norm() < kShortest) {
    return;
  }
  Eigen::Isometry3d X = At(0.5 * p);
  X.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), p).toRotationMatrix();
  log::AddCylinder(X, kRodRadius, p.norm(), colour, entity);
}

void AddTarget(const features::TargetFeature& target, foxglove::SceneEntity& entity) {
  const Eigen::Vector3f colour(0.6F, 0.03F, 0.02F);
  const features::TargetBody body = features::TraitsOf(target.target).body;
  if (body == features::TargetBody::kBall) {
    log::AddSphere(At(Eigen::Vector3d::Zero()), target.radius, colour, entity);
  } else if (body == features::TargetBody::kDisc) {
    log::AddCylinder(At(Eigen::Vector3d::Zero()), target.radius, kThickness, colour, entity);
  } else {
    foxglove::TriangleListPrimitive& plate = log::AddTriangles(At(Eigen::Vector3d::Zero()), entity);
    for (int i = 0; i < target.corners.num_corners; ++i) {
      log::AddPoint(target.corners.corners[static_cast<std::size_t>(i)].cast<float>(), colour, plate);
    }
    for (int i = 2; i < target.corners.num_corners; ++i) {
      for (const int corner : {0, i, i - 1}) {
        plate.add_indices(static_cast<std::uint32_t>(corner));
      }
    }
  }
}

}  // namespace

std::vector<log::LinkFrame> MakeLinkFrames(const robots::Robot& robot, bool has_camera,
                                           const model::Pose& X_EC) {
  std::vector<log::LinkFrame> frames{{robot.base_link, -1, model::Pose{}}};
  const int joints = robot.model.num_joints;
  frames.reserve(static_cast<std::size_t>(joints) + 2);
  for (int i = 0; i < joints; ++i) {
    frames.push_back({robot.joint_names[static_cast<std::size_t>(i)], i, model::Pose{}});
  }
  if (has_camera) {
    frames.push_back({log::kCameraFrame, joints - 1, robot.model.X_LnE * X_EC});
  }
  return frames;
}

foxglove::SceneUpdate MakeSceneMessage(const robots::Robot& robot, bool has_camera,
                                       const features::TargetFeature& target) {
  const Eigen::Vector3f light(0.8F, 0.8F, 0.8F);
  const Eigen::Vector3f dark(0.25F, 0.27F, 0.3F);
  const model::ArmModel& arm = robot.model;
  foxglove::SceneUpdate update;
  AddRod(arm.joints[0].X_PJ.p, light, log::AddEntity(robot.base_link, robot.base_link, update));
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    foxglove::SceneEntity& link = log::AddEntity(robot.joint_names[k], robot.joint_names[k], update);
    log::AddCylinder(At(Eigen::Vector3d::Zero()), kJointRadius, kJointLength, dark, link);
    AddRod(i + 1 < arm.num_joints ? arm.joints[k + 1].X_PJ.p : arm.X_LnE.p, light, link);
  }
  if (has_camera) {
    log::AddCamera(update);
    AddTarget(target, log::AddEntity("target", log::kTargetFrame, update));
  }
  return update;
}

}  // namespace fovea::hw
