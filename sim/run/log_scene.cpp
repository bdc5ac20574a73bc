// SPDX-License-Identifier: Apache-2.0
#include "sim/run/log_scene.hpp"

#include "firmware/core/model/kinematics.hpp"
#include "firmware/host/recording/log/scene_message.hpp"
#include "firmware/host/recording/log/topics.hpp"
#include "foxglove/scene.pb.h"
#include "sim/render/bench.hpp"

namespace fovea::sim {
namespace {

model::Pose ToPose(const Eigen::Isometry3d& X) { return {X.linear(), X.translation()}; }

void AddMesh(const Eigen::Isometry3d& X, const Mesh& mesh, foxglove::SceneEntity& entity) {
  foxglove::TriangleListPrimitive& triangles = log::AddTriangles(X, entity);
  for (const Vertex& vertex : mesh.vertices) {
    log::AddPoint(vertex.position, vertex.colour, triangles);
  }
  triangles.mutable_indices()->Add(mesh.indices.begin(), mesh.indices.end());
}

void AddShape(const Shape& shape, foxglove::SceneEntity& entity) {
  switch (shape.kind) {
    case ShapeKind::kBox: log::AddBox(shape.X_LS, shape.size, shape.colour, entity); return;
    case ShapeKind::kCylinder:
      log::AddCylinder(shape.X_LS, shape.size[0], shape.size[1], shape.colour, entity);
      return;
    case ShapeKind::kSphere: log::AddSphere(shape.X_LS, shape.size[0], shape.colour, entity); return;
    case ShapeKind::kMesh: AddMesh(shape.X_LS, *shape.mesh, entity); return;
  }
}

Eigen::Isometry3d At(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

void AddObstacles(const Bench& bench, foxglove::SceneEntity& entity) {
  for (const Eigen::AlignedBox3d& box : bench.boxes) {
    const Eigen::Vector3d centre = box.center();
    log::AddBox(At(centre.x(), centre.y(), centre.z()), box.sizes(), kObstacleColour, entity);
  }
}

// The log's target frame has no orientation for a disc, so the disc is drawn in its initial orientation.
void AddTarget(const RenderScene& scene, foxglove::SceneEntity& entity) {
  const TargetShape& target = scene.target;
  if (target.kind == TargetShape::Kind::kBall) {
    log::AddSphere(At(0.0, 0.0, 0.0), target.radius, scene.target_colour, entity);
    return;
  }
  if (target.kind == TargetShape::Kind::kDisc) {
    Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
    turned.linear() = scene.target_R_BO;
    log::AddCylinder(turned, target.radius, 0.001, scene.target_colour, entity);
    return;
  }
  Mesh plate;
  for (const Eigen::Vector2d& corner : target.corners) {
    plate.vertices.push_back(
        {Eigen::Vector3f(static_cast<float>(corner.x()), static_cast<float>(corner.y()), 0.0F),
         -Eigen::Vector3f::UnitZ(), scene.target_colour});
  }
  for (std::uint32_t i = 2; i < plate.vertices.size(); ++i) {
    plate.indices.insert(plate.indices.end(), {0, i, i - 1});
  }
  AddMesh(Eigen::Isometry3d::Identity(), plate, entity);
}

}  // namespace

std::vector<log::LinkFrame> MakeLinkFrames(const SimRobot& robot, const model::ArmModel& arm,
                                           const Eigen::Isometry3d& X_EC) {
  // All frames with every joint at 0, by the robot's links and by the servo's model.
  model::VecN q(arm.num_joints);
  q.setZero();
  model::ArmPoses poses;
  model::ComputePoses(arm, q, poses);
  std::vector<Eigen::Isometry3d> X_BL;
  std::vector<int> carrier;  // the joint that moves each link
  std::vector<log::LinkFrame> frames;
  for (const SimLink& link : robot.links) {
    const bool is_base = link.parent < 0;
    const auto parent = static_cast<std::size_t>(link.parent);
    X_BL.push_back(is_base ? Eigen::Isometry3d::Identity() : X_BL[parent] * link.X_PL);
    carrier.push_back(link.dof >= 0 || is_base ? link.dof : carrier[parent]);
    const int joint = carrier.back();
    const model::Pose X_BJ = joint < 0 ? model::Pose{} : poses.X_BL[static_cast<std::size_t>(joint)];
    frames.push_back({link.name, joint, X_BJ.Inverse() * ToPose(X_BL.back())});
  }
  frames.push_back({log::kCameraFrame, arm.num_joints - 1, arm.X_LnE * ToPose(X_EC)});
  return frames;
}

foxglove::SceneUpdate MakeSceneMessage(const RenderScene& scene) {
  foxglove::SceneUpdate update;
  for (const SimLink& link : scene.robot.links) {
    // Boxes are shapes of the arm's base, so that pages draw them as they draw the arm.
    const bool carries_boxes = link.parent < 0 && !scene.bench->boxes.empty();
    if (link.visuals.empty() && !carries_boxes) {
      continue;
    }
    foxglove::SceneEntity& entity = log::AddEntity(link.name, link.name, update);
    for (const Shape& shape : link.visuals) {
      AddShape(shape, entity);
    }
    if (carries_boxes) {
      AddObstacles(*scene.bench, entity);
    }
  }
  const Eigen::Vector3d table = Eigen::Vector3f(kTableWidth, kTableDepth, kTableThickness).cast<double>();
  log::AddBox(At(static_cast<double>(kTableX), 0.0, -0.5 * table.z()), table, {0.42F, 0.40F, 0.37F},
              log::AddEntity("table", log::kBaseFrame, update));
  if (!scene.has_eye) {
    return update;
  }
  log::AddCamera(update);
  AddTarget(scene, log::AddEntity("target", log::kTargetFrame, update));
  return update;
}

}  // namespace fovea::sim
