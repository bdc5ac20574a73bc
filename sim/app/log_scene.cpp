#include "sim/app/log_scene.hpp"

#include <cmath>

#include "fovea/log/topics.hpp"
#include "fovea/model/kinematics.hpp"
#include "foxglove/scene.pb.h"

namespace fovea::sim {
namespace {

model::Pose ToPose(const Eigen::Isometry3d& X) { return {X.linear(), X.translation()}; }

void SetPose(const Eigen::Isometry3d& X, foxglove::Pose& pose) {
  pose.mutable_position()->set_x(X.translation().x());
  pose.mutable_position()->set_y(X.translation().y());
  pose.mutable_position()->set_z(X.translation().z());
  const Eigen::Quaterniond q(X.linear());
  pose.mutable_orientation()->set_w(q.w());
  pose.mutable_orientation()->set_x(q.x());
  pose.mutable_orientation()->set_y(q.y());
  pose.mutable_orientation()->set_z(q.z());
}

// Viewers show colours as screens do; ours are linear.
void SetColour(const Eigen::Vector3f& linear, foxglove::Color& colour) {
  const auto shown = [](float value) { return std::pow(static_cast<double>(value), 1.0 / 2.2); };
  colour.set_r(shown(linear.x()));
  colour.set_g(shown(linear.y()));
  colour.set_b(shown(linear.z()));
  colour.set_a(1.0);
}

void SetSize(double x, double y, double z, foxglove::Vector3& size) {
  size.set_x(x);
  size.set_y(y);
  size.set_z(z);
}

foxglove::SceneEntity& AddEntity(const std::string& id, const std::string& frame,
                                 foxglove::SceneUpdate& update) {
  foxglove::SceneEntity& entity = *update.add_entities();
  entity.set_id(id);
  entity.set_frame_id(frame);
  entity.set_frame_locked(true);
  entity.mutable_timestamp()->set_seconds(0);
  return entity;
}

void AddBox(const Eigen::Isometry3d& X, const Eigen::Vector3d& size, const Eigen::Vector3f& colour,
            foxglove::SceneEntity& entity) {
  foxglove::CubePrimitive& cube = *entity.add_cubes();
  SetPose(X, *cube.mutable_pose());
  SetSize(size.x(), size.y(), size.z(), *cube.mutable_size());
  SetColour(colour, *cube.mutable_color());
}

void AddCylinder(const Eigen::Isometry3d& X, double radius, double length, const Eigen::Vector3f& colour,
                 foxglove::SceneEntity& entity) {
  foxglove::CylinderPrimitive& cylinder = *entity.add_cylinders();
  SetPose(X, *cylinder.mutable_pose());
  SetSize(2.0 * radius, 2.0 * radius, length, *cylinder.mutable_size());
  cylinder.set_bottom_scale(1.0);
  cylinder.set_top_scale(1.0);
  SetColour(colour, *cylinder.mutable_color());
}

void AddSphere(const Eigen::Isometry3d& X, double radius, const Eigen::Vector3f& colour,
               foxglove::SceneEntity& entity) {
  foxglove::SpherePrimitive& sphere = *entity.add_spheres();
  SetPose(X, *sphere.mutable_pose());
  SetSize(2.0 * radius, 2.0 * radius, 2.0 * radius, *sphere.mutable_size());
  SetColour(colour, *sphere.mutable_color());
}

void AddMesh(const Eigen::Isometry3d& X, const Mesh& mesh, foxglove::SceneEntity& entity) {
  foxglove::TriangleListPrimitive& triangles = *entity.add_triangles();
  SetPose(X, *triangles.mutable_pose());
  for (const Vertex& vertex : mesh.vertices) {
    foxglove::Point3& point = *triangles.add_points();
    point.set_x(static_cast<double>(vertex.position.x()));
    point.set_y(static_cast<double>(vertex.position.y()));
    point.set_z(static_cast<double>(vertex.position.z()));
    SetColour(vertex.colour, *triangles.add_colors());
  }
  triangles.mutable_indices()->Add(mesh.indices.begin(), mesh.indices.end());
  if (!mesh.vertices.empty()) {
    SetColour(mesh.vertices.front().colour, *triangles.mutable_color());
  }
}

void AddShape(const Shape& shape, foxglove::SceneEntity& entity) {
  switch (shape.kind) {
    case ShapeKind::kBox: AddBox(shape.X_LS, shape.size, shape.colour, entity); return;
    case ShapeKind::kCylinder:
      AddCylinder(shape.X_LS, shape.size[0], shape.size[1], shape.colour, entity);
      return;
    case ShapeKind::kSphere: AddSphere(shape.X_LS, shape.size[0], shape.colour, entity); return;
    case ShapeKind::kMesh: AddMesh(shape.X_LS, *shape.mesh, entity); return;
  }
}

Eigen::Isometry3d At(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

// The log's target frame turns with what shows its turn; a disc is shown as it lies at the start.
void AddTarget(const RenderScene& scene, foxglove::SceneEntity& entity) {
  const TargetShape& target = scene.target;
  if (target.kind == TargetShape::Kind::kBall) {
    AddSphere(At(0.0, 0.0, 0.0), target.radius, scene.target_colour, entity);
    return;
  }
  if (target.kind == TargetShape::Kind::kDisc) {
    Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
    turned.linear() = scene.target_R_BO;
    AddCylinder(turned, target.radius, 0.001, scene.target_colour, entity);
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
  // Where all frames are when every joint is at 0, once by the robot's links and once by the servo's model.
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
  const Eigen::Vector3f dark(0.07F, 0.075F, 0.08F);
  foxglove::SceneUpdate update;
  for (const SimLink& link : scene.robot.links) {
    if (link.visuals.empty()) {
      continue;
    }
    foxglove::SceneEntity& entity = AddEntity(link.name, link.name, update);
    for (const Shape& shape : link.visuals) {
      AddShape(shape, entity);
    }
  }
  AddBox(At(0.35, 0.0, -0.01), {1.6, 1.3, 0.018}, {0.42F, 0.40F, 0.37F},
         AddEntity("table", log::kBaseFrame, update));
  if (!scene.has_eye) {
    return update;
  }
  foxglove::SceneEntity& camera = AddEntity("camera", log::kCameraFrame, update);
  AddBox(At(0.0, 0.0, -0.042), {0.034, 0.034, 0.040}, dark, camera);
  AddCylinder(At(0.0, 0.0, -0.013), 0.0155, 0.022, dark, camera);
  AddTarget(scene, AddEntity("target", log::kTargetFrame, update));
  return update;
}

}  // namespace fovea::sim
