// Shapes of a bench as a log's viewer draws them.
#pragma once

#include <Eigen/Geometry>
#include <string>

namespace foxglove {
class SceneEntity;
class SceneUpdate;
class TriangleListPrimitive;
}  // namespace foxglove

namespace fovea::log {

// What stands in `frame` and goes with it.
foxglove::SceneEntity& AddEntity(const std::string& id, const std::string& frame,
                                 foxglove::SceneUpdate& update);

// Each at X in the entity's frame; sizes in m, colours linear, 0 to 1.
void AddBox(const Eigen::Isometry3d& X, const Eigen::Vector3d& size, const Eigen::Vector3f& colour,
            foxglove::SceneEntity& entity);
void AddCylinder(const Eigen::Isometry3d& X, double radius, double length, const Eigen::Vector3f& colour,
                 foxglove::SceneEntity& entity);
void AddSphere(const Eigen::Isometry3d& X, double radius, const Eigen::Vector3f& colour,
               foxglove::SceneEntity& entity);
// Without its points.
foxglove::TriangleListPrimitive& AddTriangles(const Eigen::Isometry3d& X, foxglove::SceneEntity& entity);
void AddPoint(const Eigen::Vector3f& position, const Eigen::Vector3f& colour,
              foxglove::TriangleListPrimitive& triangles);

// The camera's housing and lens, in kCameraFrame.
void AddCamera(foxglove::SceneUpdate& update);

}  // namespace fovea::log
