// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/recording/log/scene_message.hpp"

#include <cmath>

#include "firmware/host/recording/log/topics.hpp"
#include "foxglove/scene.pb.h"

namespace fovea::log {
namespace {

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

// Viewers take gamma-encoded colours; ours are linear.
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

Eigen::Isometry3d At(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

}  // namespace

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

foxglove::TriangleListPrimitive& AddTriangles(const Eigen::Isometry3d& X, foxglove::SceneEntity& entity) {
  foxglove::TriangleListPrimitive& triangles = *entity.add_triangles();
  SetPose(X, *triangles.mutable_pose());
  return triangles;
}

void AddPoint(const Eigen::Vector3f& position, const Eigen::Vector3f& colour,
              foxglove::TriangleListPrimitive& triangles) {
  if (triangles.points_size() == 0) {
    SetColour(colour, *triangles.mutable_color());
  }
  foxglove::Point3& point = *triangles.add_points();
  point.set_x(static_cast<double>(position.x()));
  point.set_y(static_cast<double>(position.y()));
  point.set_z(static_cast<double>(position.z()));
  SetColour(colour, *triangles.add_colors());
}

void AddCamera(foxglove::SceneUpdate& update) {
  const Eigen::Vector3f dark(0.07F, 0.075F, 0.08F);
  foxglove::SceneEntity& camera = AddEntity("camera", kCameraFrame, update);
  AddBox(At(0.0, 0.0, -0.042), {0.034, 0.034, 0.040}, dark, camera);
  AddCylinder(At(0.0, 0.0, -0.013), 0.0155, 0.022, dark, camera);
}

}  // namespace fovea::log
