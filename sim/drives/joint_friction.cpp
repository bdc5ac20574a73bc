// SPDX-License-Identifier: Apache-2.0
#include "sim/drives/joint_friction.hpp"

#include <algorithm>
#include <cmath>

#include "fovea/hal/types.hpp"

namespace fovea::sim {
namespace {

constexpr double kStictionSpeed = 0.02;  // Coulomb friction reaches its full size beyond this [rad/s, m/s]

// The inertia of a single link about its own joint, with its rotor [kg m^2, kg].
double OwnInertia(const SimLink& link) {
  if (link.joint == SimJointKind::kPrismatic) {
    return link.mass + link.rotor_inertia;
  }
  const Eigen::Matrix3d I_L = link.X_LCom.linear() * link.I_Com * link.X_LCom.linear().transpose();
  return link.axis_L.dot(I_L * link.axis_L) +
         link.mass * link.axis_L.cross(link.X_LCom.translation()).squaredNorm() + link.rotor_inertia;
}

}  // namespace

JointFriction::JointFriction(const SimRobot& robot, const SimRobot& believed, double compensated, bool holds,
                             bool on_motors)
    : holds_(holds) {
  for (std::size_t i = 0; i < robot.links.size(); ++i) {
    const SimLink& link = robot.links[i];
    if (link.dof >= 0) {
      // On a light link, the full friction of one step would reverse the speed. Each of its two parts
      // therefore removes at most half of the speed per step.
      const auto left = [&](double friction, double friction_believed) {
        return friction == friction_believed ? (1.0 - compensated) * friction
                                             : friction - compensated * friction_believed;
      };
      const double inertia = on_motors ? link.rotor_inertia : OwnInertia(link);
      const double most = 0.5 * inertia / hal::kTickPeriodS;  // damping of one part [N m s/rad, N s/m]
      viscous_.push_back(std::min(left(link.viscous, believed.links[i].viscous), most));
      coulomb_.push_back(left(link.coulomb, believed.links[i].coulomb));
      stiction_speed_.push_back(std::max(kStictionSpeed, std::fabs(coulomb_.back()) / most));
    }
  }
}

double JointFriction::Torque(int joint, double velocity) const {
  const auto k = static_cast<std::size_t>(joint);
  if (holds_) {
    // Friction is held in Holding(); what the controller compensates too much pushes a moving joint.
    return viscous_[k] * velocity + std::min(coulomb_[k], 0.0) * std::tanh(velocity / stiction_speed_[k]);
  }
  return viscous_[k] * velocity + coulomb_[k] * std::tanh(velocity / stiction_speed_[k]);
}

Eigen::VectorXd JointFriction::Holding() const {
  return Eigen::Map<const Eigen::VectorXd>(coulomb_.data(), static_cast<Eigen::Index>(coulomb_.size()))
      .cwiseMax(0.0);
}

}  // namespace fovea::sim
