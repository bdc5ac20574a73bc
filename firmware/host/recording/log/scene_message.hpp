// SPDX-License-Identifier: Apache-2.0
// Shapes of a bench for a log's viewer.
#pragma once

#include <Eigen/Geometry>
#include <string>

namespace foxglove {
class SceneEntity;
class SceneUpdate;
class TriangleListPrimitive;
}  // namespace foxglove

namespace fovea::log {

// Adds an entity that is fixed to `frame`.
foxglove::SceneEntity& AddEntity(const std::string& id, const std::string& frame,
                                 foxglove::SceneUpdate& update);

// Each adds a shape at pose X in the entity's frame; sizes in m, colours linear, 0 to 1.
void AddBox(const Eigen::Isometry3d& X, const Eigen::Vector3d& size, const Eigen::Vector3f& colour,
            foxglove::SceneEntity& entity);
void AddCylinder(const Eigen::Isometry3d& X, double radius, double length, const Eigen::Vector3f& colour,
                 foxglove::SceneEntity& entity);
void AddSphere(const Eigen::Isometry3d& X, double radius, const Eigen::Vector3f& colour,
               foxglove::SceneEntity& entity);
// Adds an empty list; AddPoint adds its points.
foxglove::TriangleListPrimitive& AddTriangles(const Eigen::Isometry3d& X, foxglove::SceneEntity& entity);
void AddPoint(const Eigen::Vector3f& position, const Eigen::Vector3f& colour,
              foxglove::TriangleListPrimitive& triangles);

// The camera's housing and lens, in kCameraFrame.
void AddCamera(foxglove::SceneUpdate& update);

}  // namespace fovea::log
