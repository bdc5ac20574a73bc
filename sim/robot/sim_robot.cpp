// SPDX-License-Identifier: Apache-2.0
#include "sim/robot/sim_robot.hpp"

#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <optional>
#include <stdexcept>
#include <utility>

#include "sim/robot/mesh_file.hpp"
#include "sim/robot/mesh_path.hpp"

namespace fovea::sim {
namespace {

Eigen::Isometry3d ToIsometry(const urdf::Pose& pose) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z);
  const urdf::Rotation& r = pose.rotation;
  X.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
  return X;
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, const std::string& base, const std::string& tip,
         std::filesystem::path root)
      : file_(file.string()), urdf_(urdf::parseURDFFile(file_)), tip_(tip), root_(std::move(root)) {
    if (!urdf_ || !urdf_->getLink(base)) {
      Fail("no link \"" + base + "\" to simulate");
    }
    AddLink(urdf_->getLink(base), -1);
    if (robot_.tip < 0) {
      Fail("no link \"" + tip + "\" below \"" + base + "\"");
    }
  }

  SimRobot robot_;

 private:
  [[noreturn]] void Fail(const std::string& what) const { throw std::runtime_error(file_ + ": " + what); }

  void AddLink(const urdf::LinkConstSharedPtr& from, int parent) {
    const int index = static_cast<int>(robot_.links.size());
    robot_.links.emplace_back();
    SimLink& link = robot_.links.back();
    link.name = from->name;
    link.parent = parent;
    if (parent >= 0) {
      AddJoint(*from->parent_joint, link);
    }
    if (from->inertial) {
      const urdf::Inertial& in = *from->inertial;
      link.mass = in.mass;
      link.X_LCom = ToIsometry(in.origin);
      link.I_Com << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
    }
    for (const auto& visual : from->visual_array) {
      std::optional<Eigen::Vector3f> colour;
      if (visual->material) {
        const urdf::Color& given = visual->material->color;
        colour.emplace(given.r, given.g, given.b);
      }
      link.visuals.push_back(ToShape(*visual->geometry, ToIsometry(visual->origin), colour, link.name));
    }
    for (const auto& collision : from->collision_array) {
      link.collisions.push_back(
          ToShape(*collision->geometry, ToIsometry(collision->origin), std::nullopt, link.name));
    }
    if (link.name == tip_) {
      robot_.tip = index;
    }
    for (const auto& child : from->child_links) {
      AddLink(child, index);
    }
  }

  void AddJoint(const urdf::Joint& joint, SimLink& link) {
    link.X_PL = ToIsometry(joint.parent_to_joint_origin_transform);
    if (joint.type == urdf::Joint::FIXED) {
      return;
    }
    link.joint = joint.type == urdf::Joint::PRISMATIC ? SimJointKind::kPrismatic : SimJointKind::kRevolute;
    link.dof = robot_.num_dofs++;
    link.axis_L = Eigen::Vector3d(joint.axis.x, joint.axis.y, joint.axis.z).normalized();
    if (joint.dynamics) {
      link.viscous = joint.dynamics->damping;
      link.coulomb = joint.dynamics->friction;
    }
  }

  Shape ToShape(const urdf::Geometry& geometry, const Eigen::Isometry3d& X_LS,
                const std::optional<Eigen::Vector3f>& colour, const std::string& link) const {
    Shape shape;
    shape.X_LS = X_LS;
    shape.colour = colour.value_or(shape.colour);
    switch (geometry.type) {
      case urdf::Geometry::BOX: {
        const urdf::Vector3& dim = static_cast<const urdf::Box&>(geometry).dim;
        shape.kind = ShapeKind::kBox;
        shape.size = {dim.x, dim.y, dim.z};
        break;
      }
      case urdf::Geometry::CYLINDER: {
        const auto& cylinder = static_cast<const urdf::Cylinder&>(geometry);
        shape.kind = ShapeKind::kCylinder;
        shape.size = {cylinder.radius, cylinder.length, 0.0};
        break;
      }
      case urdf::Geometry::SPHERE:
        shape.kind = ShapeKind::kSphere;
        shape.size = {static_cast<const urdf::Sphere&>(geometry).radius, 0.0, 0.0};
        break;
      case urdf::Geometry::MESH: {
        shape.kind = ShapeKind::kMesh;
        shape.mesh = ReadMesh(static_cast<const urdf::Mesh&>(geometry), colour, link);
        return shape;
      }
      default:
        Fail(fmt::format("link \"{}\": only box, cylinder, sphere and mesh shapes can be simulated", link));
    }
    if (!(shape.size[0] > 0.0)) {
      Fail(fmt::format("link \"{}\": a shape has no size", link));
    }
    return shape;
  }

  std::shared_ptr<const Mesh> ReadMesh(const urdf::Mesh& from, const std::optional<Eigen::Vector3f>& colour,
                                       const std::string& link) const {
    try {
      const urdf::Vector3& scale = from.scale;
      Mesh mesh = LoadMeshFile(FindMeshFile(file_, from.filename, root_), {scale.x, scale.y, scale.z}, root_);
      if (colour) {
        for (Vertex& vertex : mesh.vertices) {
          vertex.colour = *colour;
        }
      }
      return std::make_shared<const Mesh>(std::move(mesh));
    } catch (const std::exception& error) {
      Fail(fmt::format("link \"{}\": mesh \"{}\": {}", link, from.filename, error.what()));
    }
  }

  std::string file_;
  urdf::ModelInterfaceSharedPtr urdf_;
  std::string tip_;
  std::filesystem::path root_;
};

}  // namespace

SimRobot LoadSimRobot(const std::filesystem::path& urdf, const std::string& base_link,
                      const std::string& tip_link, const std::filesystem::path& root) {
  return std::move(Reader(urdf, base_link, tip_link, root).robot_);
}

}  // namespace fovea::sim
