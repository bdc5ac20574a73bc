// SPDX-License-Identifier: Apache-2.0
// Our kinematics and dynamics against KDL's, which share neither code nor formulation: KDL works link by link
// in link frames, ours about the base's origin. Both read the same URDF; BuildKdlChain makes KDL's chain.
#include <gtest/gtest.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <iostream>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/load.hpp"
#include "firmware/host/robots/robot.hpp"
#include "tests/support/places.hpp"
#include "tests/support/random_states.hpp"

namespace fovea {
namespace {

constexpr int kStates = 5000;

KDL::Frame ToKdl(const urdf::Pose& pose) {
  double x = 0, y = 0, z = 0, w = 0;
  pose.rotation.getQuaternion(x, y, z, w);
  return {KDL::Rotation::Quaternion(x, y, z, w), {pose.position.x, pose.position.y, pose.position.z}};
}

KDL::Chain BuildKdlChain(const robots::Robot& robot) {
  const auto urdf = urdf::parseURDFFile(robot.urdf.string());
  std::vector<urdf::JointConstSharedPtr> joints;
  for (auto link = urdf->getLink(robot.tip_link); link->name != robot.base_link; link = link->getParent()) {
    joints.push_back(link->parent_joint);
  }
  std::reverse(joints.begin(), joints.end());
  KDL::Chain chain;
  std::size_t moving = 0;
  for (const auto& joint : joints) {
    const KDL::Frame X = ToKdl(joint->parent_to_joint_origin_transform);
    const KDL::Vector axis(joint->axis.x, joint->axis.y, joint->axis.z);
    KDL::Joint kdl_joint(joint->name, KDL::Joint::None);
    const double rotor =
        joint->type == urdf::Joint::FIXED ? 0.0 : robot.model.joints.at(moving++).rotor_inertia;
    if (joint->type == urdf::Joint::REVOLUTE || joint->type == urdf::Joint::CONTINUOUS) {
      kdl_joint = KDL::Joint(joint->name, X.p, X.M * axis, KDL::Joint::RotAxis, 1.0, 0.0, rotor);
    } else if (joint->type == urdf::Joint::PRISMATIC) {
      kdl_joint = KDL::Joint(joint->name, X.p, X.M * axis, KDL::Joint::TransAxis, 1.0, 0.0, rotor);
    }
    KDL::RigidBodyInertia inertia = KDL::RigidBodyInertia::Zero();
    if (const auto& in = urdf->getLink(joint->child_link_name)->inertial) {
      const KDL::Frame X_LC = ToKdl(in->origin);
      const KDL::RotationalInertia I(in->ixx, in->iyy, in->izz, in->ixy, in->ixz, in->iyz);
      inertia = X_LC.M * KDL::RigidBodyInertia(in->mass, KDL::Vector::Zero(), I);
      inertia = KDL::Frame(X_LC.p) * inertia;
    }
    chain.addSegment(KDL::Segment(joint->child_link_name, kdl_joint, X, inertia));
  }
  return chain;
}

KDL::JntArray ToKdl(const model::VecN& v) {
  KDL::JntArray array(static_cast<unsigned>(v.size()));
  array.data = v;
  return array;
}

// Each joint with a rotor of another inertia.
robots::Robot LoadWithRotors(const std::string& file) {
  robots::Robot robot = robots::LoadRobot(file);
  for (int i = 0; i < robot.model.num_joints; ++i) {
    robot.model.joints[static_cast<std::size_t>(i)].rotor_inertia = 0.6 / (1.0 + i);
  }
  return robot;
}

class KdlTest : public testing::TestWithParam<const char*> {
 protected:
  KdlTest() : robot_(LoadWithRotors(test::RobotsFolder() + GetParam())), chain_(BuildKdlChain(robot_)) {
    // Every arm carries a load beside its flange, with six different moments of inertia.
    model::Load load;
    load.mass = 1.7;
    load.p_ECom = {0.03, -0.05, 0.11};
    load.I_Com_E << 0.012, 0.001, -0.002, 0.001, 0.015, 0.003, -0.002, 0.003, 0.010;
    model::Attach(load, robot_.model);
    const KDL::RotationalInertia I(0.012, 0.015, 0.010, 0.001, -0.002, 0.003);
    chain_.addSegment(KDL::Segment("load", KDL::Joint(KDL::Joint::None), KDL::Frame::Identity(),
                                   KDL::RigidBodyInertia(1.7, {0.03, -0.05, 0.11}, I)));
  }

  robots::Robot robot_;
  KDL::Chain chain_;
  test::RandomStates random_{1};
};

TEST_P(KdlTest, PosesAndJacobianAgree) {
  const model::ArmModel& arm = robot_.model;
  ASSERT_EQ(chain_.getNrOfJoints(), static_cast<unsigned>(arm.num_joints));
  KDL::ChainFkSolverPos_recursive fk(chain_);
  KDL::ChainJntToJacSolver jac(chain_);
  double worst_pose = 0.0;
  double worst_jacobian = 0.0;
  for (int k = 0; k < kStates; ++k) {
    const model::VecN q = random_.Position(arm);
    model::ArmPoses poses;
    model::ComputePoses(arm, q, poses);
    model::Mat6N J;
    model::ComputeJacobian(arm, poses, model::Pose{}, J);

    KDL::Frame X_BE;
    ASSERT_GE(fk.JntToCart(ToKdl(q), X_BE), 0);
    KDL::Jacobian J_kdl(chain_.getNrOfJoints());
    ASSERT_GE(jac.JntToJac(ToKdl(q), J_kdl), 0);
    model::Mat6N J_B;
    model::ComputeBaseJacobian(arm, poses, J_B);
    worst_jacobian = std::max(worst_jacobian, (J_kdl.data - J_B).cwiseAbs().maxCoeff());
    const model::VecN dq = random_.Joints(arm, 1.0);
    worst_jacobian = std::max(
        worst_jacobian,
        (J_kdl.data.bottomRows<3>() * dq - model::AngularVelocity(arm, poses, dq)).cwiseAbs().maxCoeff());
    J_kdl.changeBase(X_BE.M.Inverse());  // KDL's is in axes of B, ours in axes of E
    for (int r = 0; r < 3; ++r) {
      worst_pose = std::max(worst_pose, std::abs(X_BE.p[r] - poses.X_BE.p[r]));
      for (int c = 0; c < 3; ++c) {
        worst_pose = std::max(worst_pose, std::abs(X_BE.M(r, c) - poses.X_BE.R(r, c)));
      }
    }
    worst_jacobian = std::max(worst_jacobian, (J_kdl.data - J).cwiseAbs().maxCoeff());
  }
  std::cout << "worst difference over " << kStates << " states: pose " << worst_pose << ", Jacobian "
            << worst_jacobian << "\n";
  EXPECT_LT(worst_pose, 1e-14);
  EXPECT_LT(worst_jacobian, 1e-14);
}

TEST_P(KdlTest, BiasAccelerationAgrees) {
  const model::ArmModel& arm = robot_.model;
  KDL::ChainJntToJacDotSolver solver(chain_);
  solver.setHybridRepresentation();  // of E's origin, in axes of B
  double worst = 0.0;
  for (int k = 0; k < kStates; ++k) {
    const model::VecN q = random_.Position(arm);
    const model::VecN dq = random_.Joints(arm, 2.0);
    model::ArmPoses poses;
    model::ComputePoses(arm, q, poses);
    const model::Vec6 bias = model::BiasAcceleration(arm, poses, dq);
    KDL::Twist of_kdl;
    ASSERT_GE(solver.JntToJacDot(KDL::JntArrayVel(ToKdl(q), ToKdl(dq)), of_kdl), 0);
    for (int r = 0; r < 3; ++r) {
      worst = std::max(worst, std::abs(bias[r] - of_kdl.vel[r]));
      worst = std::max(worst, std::abs(bias[r + 3] - of_kdl.rot[r]));
    }
  }
  std::cout << "worst difference over " << kStates << " states: " << worst << "\n";
  EXPECT_LT(worst, 1e-13);
}

TEST_P(KdlTest, DynamicsAgree) {
  const model::ArmModel& arm = robot_.model;
  const KDL::Vector g(arm.g_B.x(), arm.g_B.y(), arm.g_B.z());
  KDL::ChainDynParam dynamics(chain_, g);
  KDL::ChainIdSolver_RNE inverse(chain_, g);
  const unsigned n = chain_.getNrOfJoints();
  double worst_M = 0, worst_C = 0, worst_g = 0, worst_tau = 0;
  for (int k = 0; k < kStates; ++k) {
    const model::VecN q = random_.Position(arm);
    const model::VecN dq = random_.Joints(arm, 2.0);
    const model::VecN ddq = random_.Joints(arm, 10.0);
    model::ArmPoses poses;
    model::ComputePoses(arm, q, poses);
    model::ArmDynamics ours;
    model::ComputeDynamics(arm, poses, dq, ours);
    model::VecN tau;
    model::InverseDynamics(arm, poses, dq, ddq, tau);

    KDL::JntSpaceInertiaMatrix M(static_cast<int>(n));
    KDL::JntArray C(n), G(n), tau_kdl(n);
    KDL::Wrenches none(chain_.getNrOfSegments(), KDL::Wrench::Zero());
    ASSERT_GE(dynamics.JntToMass(ToKdl(q), M), 0);
    ASSERT_GE(dynamics.JntToCoriolis(ToKdl(q), ToKdl(dq), C), 0);
    ASSERT_GE(dynamics.JntToGravity(ToKdl(q), G), 0);
    ASSERT_GE(inverse.CartToJnt(ToKdl(q), ToKdl(dq), ToKdl(ddq), none, tau_kdl), 0);
    worst_M = std::max(worst_M, (M.data - ours.M).cwiseAbs().maxCoeff());
    worst_C = std::max(worst_C, (C.data - ours.Cdq).cwiseAbs().maxCoeff());
    worst_g = std::max(worst_g, (G.data - ours.g).cwiseAbs().maxCoeff());
    worst_tau = std::max(worst_tau, (tau_kdl.data - tau).cwiseAbs().maxCoeff());
  }
  std::cout << "worst difference over " << kStates << " states: M " << worst_M << " kg m^2, C dq " << worst_C
            << " Nm, g " << worst_g << " Nm, tau " << worst_tau << " Nm\n";
  EXPECT_LT(worst_M, 1e-13);
  EXPECT_LT(worst_C, 1e-12);
  EXPECT_LT(worst_g, 1e-12);
  EXPECT_LT(worst_tau, 1e-12);
}

// The mixed arm has prismatic joints, skew axes, fixed joints with mass and an axis that is -z.
INSTANTIATE_TEST_SUITE_P(Arms, KdlTest,
                         testing::Values("/panda.toml", "/ur5e.toml", "/puma560.toml", "/gantry.toml",
                                         "/../../../../tests/core/model/mixed_arm.urdf"));

}  // namespace
}  // namespace fovea
