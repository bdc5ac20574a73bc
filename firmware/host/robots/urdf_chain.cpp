// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/robots/urdf_chain.hpp"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <map>

#include "firmware/core/model/load.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/robots/arm_shape.hpp"

namespace fovea::robots {
namespace {

using config::InputError;
using model::Mat3;
using model::Pose;
using model::Vec3;

// Collects urdfdom's messages, so that the user gets them as part of one line.
class MessageCollector final : public console_bridge::OutputHandler {
 public:
  MessageCollector() : previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~MessageCollector() override { console_bridge::useOutputHandler(previous_); }
  MessageCollector(const MessageCollector&) = delete;
  MessageCollector& operator=(const MessageCollector&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && count_++ < kMost) {
      text_ += (text_.empty() ? "" : "; ") + text;
    }
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static constexpr int kMost = 2;  // the error and its element; later messages are consequences
  console_bridge::OutputHandler* previous_;
  std::string text_;
  int count_ = 0;
};

Vec3 ToVec3(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

Pose ToPose(const urdf::Pose& pose) {
  const urdf::Rotation& r = pose.rotation;
  Pose result;
  result.p = ToVec3(pose.position);
  const double w = r.w, x = r.x, y = r.y, z = r.z;
  result.R << 2 * (w * w + x * x) - 1, 2 * (x * y - w * z), 2 * (x * z + w * y),  //
      2 * (x * y + w * z), 2 * (w * w + y * y) - 1, 2 * (y * z - w * x),          //
      2 * (x * z - w * y), 2 * (y * z + w * x), 2 * (w * w + z * z) - 1;
  return result;
}

// A rotation that takes z to the unit vector `axis`; the identity for z itself.
Mat3 AlignZ(const Vec3& axis) {
  const Vec3 z = Vec3::UnitZ();
  const double c = z.dot(axis);
  if (c > 1.0 - 1e-12) {
    return Mat3::Identity();
  }
  if (c < -1.0 + 1e-12) {
    return Vec3(1.0, -1.0, -1.0).asDiagonal();  // half a turn about x
  }
  const Mat3 V = model::CrossMatrix(model::Cross(z, axis));
  return Mat3::Identity() + V + V * V / (1.0 + c);
}

class ChainReader {
 public:
  explicit ChainReader(Robot& robot) : robot_(robot), file_(robot.urdf.string()) {}
  // Links own their children; links in a ring would keep each other alive.
  ~ChainReader() {
    if (urdf_) {
      for (const auto& [name, link] : urdf_->links_) {
        link->child_links.clear();
      }
    }
  }
  ChainReader(const ChainReader&) = delete;
  ChainReader& operator=(const ChainReader&) = delete;

  void Read() {
    Parse();
    FindEnds();
    const std::vector<urdf::JointConstSharedPtr> chain = Chain();
    model::ArmModel& arm = robot_.model;
    // Pose of the current URDF link in the frame of the last moving link (or B before the first).
    Pose X_PU;
    std::vector<Capsules> shapes(1);
    AddBodies(base_, nullptr, shapes.back(), Pose{}, chain);
    for (const auto& joint : chain) {
      X_PU = X_PU * ToPose(joint->parent_to_joint_origin_transform);
      const urdf::LinkConstSharedPtr child = urdf_->getLink(joint->child_link_name);
      if (joint->type == urdf::Joint::FIXED) {
        continue;  // its bodies were added with the link that carries it
      }
      const model::JointType type = TypeOf(*joint);
      const Pose X_UL{AlignZ(Axis(*joint)), Vec3::Zero()};
      AddJoint(*joint, type, X_PU * X_UL);
      X_PU = X_UL.Inverse();
      Bodies bodies;
      AddBodies(child, &bodies, shapes.emplace_back(), X_PU, chain);
      arm.links[static_cast<std::size_t>(arm.num_joints - 1)] = Merge(bodies, joint->name);
    }
    if (arm.num_joints == 0) {
      Fail(fmt::format("no moving joint between links \"{}\" and \"{}\"", robot_.base_link, robot_.tip_link));
    }
    arm.X_LnE = X_PU;
    SetShape(shapes, arm);
  }

 private:
  // All in the moving link's frame.
  using Bodies = std::vector<model::LinkInertia>;
  using Capsules = std::vector<model::Capsule>;

  [[noreturn]] void Fail(const std::string& what) const { throw InputError(file_ + ": " + what); }

  void Parse() {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(robot_.urdf, ignored)) {
      Fail("no such file");
    }
    const MessageCollector messages;
    try {
      urdf_ = urdf::parseURDFFile(file_);
    } catch (const std::exception& error) {  // number parsing inside urdfdom
      Fail(fmt::format("not a usable URDF: {}", error.what()));
    }
    // After an error in a link, urdfdom drops the rest of that link and continues.
    if (!urdf_ || !messages.text().empty()) {
      Fail("not a usable URDF: " + (messages.text().empty() ? "no robot in it" : messages.text()));
    }
    std::map<std::string, std::string> parent_joint;
    for (const auto& [name, joint] : urdf_->joints_) {
      const auto [it, is_new] = parent_joint.emplace(joint->child_link_name, name);
      if (!is_new) {
        Fail(fmt::format("link \"{}\" has two parent joints, \"{}\" and \"{}\": a loop is not a serial arm",
                         joint->child_link_name, it->second, name));
      }
    }
    for (const auto& [name, link] : urdf_->links_) {
      CheckReachesRoot(*link);
    }
  }

  // Finds links in a ring apart from the root: each of them has only one parent joint.
  void CheckReachesRoot(const urdf::Link& link) const {
    std::size_t steps = 0;
    for (urdf::LinkConstSharedPtr above = link.getParent(); above; above = above->getParent()) {
      if (++steps > urdf_->links_.size()) {
        Fail(fmt::format("link \"{}\" is its own ancestor: a loop is not a serial arm", link.name));
      }
    }
  }

  void FindEnds() {
    if (robot_.base_link.empty()) {
      robot_.base_link = urdf_->getRoot()->name;
    }
    base_ = urdf_->getLink(robot_.base_link);
    if (!base_) {
      Fail(fmt::format("base link \"{}\" does not exist", robot_.base_link));
    }
    if (robot_.tip_link.empty()) {
      std::vector<std::string> leaves;
      for (const auto& [name, link] : urdf_->links_) {
        if (link->child_links.empty()) {
          leaves.push_back(name);
        }
      }
      if (leaves.size() != 1) {
        Fail(
            fmt::format("{} links could be the end effector; name one as tip in an arm file", leaves.size()));
      }
      robot_.tip_link = leaves.front();
    }
    if (!urdf_->getLink(robot_.tip_link)) {
      Fail(fmt::format("no end effector: tip link \"{}\" does not exist", robot_.tip_link));
    }
  }

  std::vector<urdf::JointConstSharedPtr> Chain() const {
    std::vector<urdf::JointConstSharedPtr> chain;
    urdf::LinkConstSharedPtr link = urdf_->getLink(robot_.tip_link);
    while (link && link->name != robot_.base_link) {
      if (link->parent_joint) {
        chain.push_back(link->parent_joint);
      }
      link = link->getParent();
    }
    if (!link) {
      Fail(fmt::format("tip link \"{}\" does not descend from base link \"{}\"", robot_.tip_link,
                       robot_.base_link));
    }
    std::reverse(chain.begin(), chain.end());
    return chain;
  }

  Vec3 Axis(const urdf::Joint& joint) const {
    const Vec3 axis = ToVec3(joint.axis);
    if (!(axis.norm() > 1e-9)) {
      Fail(fmt::format("joint \"{}\": its axis is zero", joint.name));
    }
    return axis.normalized();
  }

  model::JointType TypeOf(const urdf::Joint& joint) const {
    switch (joint.type) {
      case urdf::Joint::REVOLUTE:
      case urdf::Joint::CONTINUOUS: return model::JointType::kRevolute;
      case urdf::Joint::PRISMATIC: return model::JointType::kPrismatic;
      default:
        Fail(fmt::format("joint \"{}\": only revolute, continuous, prismatic and fixed joints can be driven",
                         joint.name));
    }
  }

  void AddJoint(const urdf::Joint& joint, model::JointType type, const Pose& X_PJ) {
    model::ArmModel& arm = robot_.model;
    if (joint.mimic) {
      Fail(fmt::format("joint \"{}\": mimic joints cannot be driven", joint.name));
    }
    if (arm.num_joints == model::kMaxJoints) {
      Fail(fmt::format("more than {} moving joints between base and tip", model::kMaxJoints));
    }
    model::Joint& out = arm.joints[static_cast<std::size_t>(arm.num_joints)];
    out.X_PJ = X_PJ;
    out.type = type;
    if (!joint.limits) {
      Fail(fmt::format("joint \"{}\": <limit> with velocity and effort is missing", joint.name));
    }
    constexpr double kEndless = 1e4;  // a continuous joint's range, far inside what SinCos takes [rad]
    const bool endless = joint.type == urdf::Joint::CONTINUOUS;
    out.q_min = endless ? -kEndless : joint.limits->lower;
    out.q_max = endless ? kEndless : joint.limits->upper;
    out.dq_max = joint.limits->velocity;
    out.tau_max = joint.limits->effort;
    if (joint.dynamics) {
      out.viscous = joint.dynamics->damping;
      out.coulomb = joint.dynamics->friction;
    }
    if (!(out.viscous >= 0.0 && out.coulomb >= 0.0)) {
      Fail(fmt::format("joint \"{}\": damping and friction must not be below 0", joint.name));
    }
    if (!(out.q_min < out.q_max)) {
      Fail(fmt::format("joint \"{}\": lower limit {} is not below upper limit {}", joint.name, out.q_min,
                       out.q_max));
    }
    if (!(out.dq_max > 0.0 && out.tau_max > 0.0)) {
      Fail(fmt::format("joint \"{}\": velocity and effort limits must be above 0", joint.name));
    }
    robot_.joint_names.push_back(joint.name);
    ++arm.num_joints;
  }

  // Adds the bodies of `link` and of all links fixed to it. `X_LU` is its pose in the moving link's frame.
  // `bodies` is null for the base, which does not move.
  void AddBodies(const urdf::LinkConstSharedPtr& link, Bodies* bodies, Capsules& shapes, const Pose& X_LU,
                 const std::vector<urdf::JointConstSharedPtr>& chain) const {
    for (const auto& collision : link->collision_array) {
      AddShape(*link, *collision, X_LU, shapes);
    }
    if (bodies != nullptr && link->inertial) {
      const urdf::Inertial& inertial = *link->inertial;
      const Pose X_LC = X_LU * ToPose(inertial.origin);
      Mat3 I;
      I << inertial.ixx, inertial.ixy, inertial.ixz,  //
          inertial.ixy, inertial.iyy, inertial.iyz,   //
          inertial.ixz, inertial.iyz, inertial.izz;
      CheckInertia(link->name, inertial.mass, I);
      bodies->push_back({inertial.mass, X_LC.p, X_LC.R * I * X_LC.R.transpose()});
    }
    for (const auto& joint : link->child_joints) {
      if (joint->type == urdf::Joint::FIXED) {
        AddBodies(urdf_->getLink(joint->child_link_name), bodies, shapes,
                  X_LU * ToPose(joint->parent_to_joint_origin_transform), chain);
      } else if (std::find(chain.begin(), chain.end(), joint) == chain.end()) {
        Fail(fmt::format("joint \"{}\" moves a branch beside the chain from \"{}\" to \"{}\"", joint->name,
                         robot_.base_link, robot_.tip_link));
      }
    }
  }

  void AddShape(const urdf::Link& link, const urdf::Collision& collision, const Pose& X_LU,
                Capsules& shapes) const {
    if (!collision.geometry || collision.geometry->type == urdf::Geometry::MESH) {
      return;  // only a simulator uses meshes
    }
    const Pose X_LS = X_LU * ToPose(collision.origin);
    model::Capsule shape;
    if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(collision.geometry.get())) {
      shape = CapsuleOfCylinder(X_LS, cylinder->length, cylinder->radius);
    } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(collision.geometry.get())) {
      shape = {X_LS.p, X_LS.p, sphere->radius};
    } else if (const auto* box = dynamic_cast<const urdf::Box*>(collision.geometry.get())) {
      shape = CapsuleOfBox(X_LS, ToVec3(box->dim));
    }
    if (!(shape.radius > 0.0) || !shape.p_LA.allFinite() || !shape.p_LB.allFinite()) {
      Fail(fmt::format("link \"{}\": <collision>: sizes must be finite and above 0", link.name));
    }
    shapes.push_back(shape);
  }

  // A rigid body has a positive mass, and principal moments that are positive and obey the triangle
  // inequality. With other values M could lose its definiteness.
  void CheckInertia(const std::string& link, double mass, const Mat3& I) const {
    const Eigen::SelfAdjointEigenSolver<Mat3> solver(I, Eigen::EigenvaluesOnly);
    const Vec3& moments = solver.eigenvalues();  // ascending
    if (!(mass > 0.0) || !I.allFinite()) {
      Fail(fmt::format("link \"{}\": mass and inertia must be finite, the mass above 0", link));
    }
    if (!(moments[0] > 0.0) || !(moments[0] + moments[1] >= moments[2] * (1.0 - 1e-6))) {
      Fail(
          fmt::format("link \"{}\": no body has principal moments of inertia {:.4g}, {:.4g}, {:.4g} kg m^2 "
                      "(each must be above 0 and below the sum of the others)",
                      link, moments[0], moments[1], moments[2]));
    }
  }

  model::LinkInertia Merge(const Bodies& bodies, const std::string& joint) const {
    if (bodies.empty()) {
      Fail(fmt::format("joint \"{}\" moves a link without <inertial>: the torque for it cannot be computed",
                       joint));
    }
    model::LinkInertia sum;
    for (const model::LinkInertia& body : bodies) {
      sum = model::Join(sum, body);
    }
    return sum;
  }

  Robot& robot_;
  std::string file_;
  urdf::ModelInterfaceSharedPtr urdf_;
  urdf::LinkConstSharedPtr base_;
};

}  // namespace

void ReadUrdfChain(Robot& robot) { ChainReader(robot).Read(); }

}  // namespace fovea::robots
