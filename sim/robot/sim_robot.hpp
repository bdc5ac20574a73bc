// SPDX-License-Identifier: Apache-2.0
// The simulator's robot: all links with their shapes, read from the URDF.
//
// Other code (firmware/host/robots) reads the servo's model from the same file; tests compare the two.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sim/robot/triangle_mesh.hpp"

namespace fovea::sim {

enum class ShapeKind { kBox, kCylinder, kSphere, kMesh };

// A solid in its link's frame. Box: size = full extents. Cylinder along z: size = (radius, length, -).
// Sphere: size = (radius, -, -). Mesh: triangles with their own size and colours.
struct Shape {
  ShapeKind kind = ShapeKind::kBox;
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  // [m]
  Eigen::Vector3f colour{0.7F, 0.7F, 0.7F};        // linear RGB, 0 to 1
  std::shared_ptr<const Mesh> mesh;                // for kMesh, in S
};

enum class SimJointKind { kFixed, kRevolute, kPrismatic };

struct SimLink {
  std::string name;
  int parent = -1;  // index of the parent link; -1 for the base itself
  SimJointKind joint = SimJointKind::kFixed;
  int dof = -1;  // index of the joint among the moving ones, base to tip
  Eigen::Isometry3d X_PL = Eigen::Isometry3d::Identity();  // at joint position 0
  Eigen::Vector3d axis_L = Eigen::Vector3d::UnitZ();
  double viscous = 0.0;                                      // friction [Nm s/rad]
  double coulomb = 0.0;                                      // friction [Nm]
  double rotor_inertia = 0.0;                                // of its motor, seen at the joint [kg m^2, kg]
  double mass = 0.0;                                         // [kg]
  Eigen::Isometry3d X_LCom = Eigen::Isometry3d::Identity();  // centre of mass, axes of the inertia
  Eigen::Matrix3d I_Com = Eigen::Matrix3d::Zero();           // [kg m^2]
  std::vector<Shape> visuals;
  std::vector<Shape> collisions;
};

struct SimRobot {
  std::vector<SimLink> links;  // parents before children; links[0] is the base
  int num_dofs = 0;
  int tip = -1;  // index of the link whose frame is E
};

// Reads `urdf` from `base_link` on, and its mesh files. mesh_path.hpp and mesh_file.hpp describe their
// locations, contents and `root`. A mesh has the colour of its URDF material, otherwise those of its file.
// std::runtime_error with one line that names the URDF, the link and the mesh: the robot cannot be simulated.
SimRobot LoadSimRobot(const std::filesystem::path& urdf, const std::string& base_link,
                      const std::string& tip_link, const std::filesystem::path& root = {});

}  // namespace fovea::sim
