// SPDX-License-Identifier: Apache-2.0
// A serial arm as numbers: plain data, fixed capacity, no pointers.
//
// Link i is what joint i moves (i = 0 .. num_joints - 1). Its frame L_i has the joint's axis as z, so that
// X_{P L_i}(q_i) = X_PJ * (turn about z by q_i, or shift along z by q_i), with P the frame L_{i-1}, or B for
// the first joint. Fixed joints of a robot description are merged into the link that carries them.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/model/arm_shape.hpp"
#include "firmware/core/model/types.hpp"

namespace fovea::model {

enum class JointType : std::uint8_t { kRevolute, kPrismatic };

// Units: rad and Nm for a revolute joint, m and N for a prismatic one.
struct Joint {
  JointType type = JointType::kRevolute;
  Pose X_PJ;  // frame L_i in its parent at q_i = 0
  double q_min = 0.0;
  double q_max = 0.0;
  double dq_max = 0.0;
  double ddq_max = 0.0;
  double dddq_max = 0.0;
  double tau_max = 0.0;
  double dtau_max = 0.0;       // fastest change of the torque command [Nm/s]
  double viscous = 0.0;        // friction per speed [Nm s/rad]
  double coulomb = 0.0;        // friction against any motion [Nm]
  double rotor_inertia = 0.0;  // of the motor's rotor, seen at the joint: times the gear's ratio squared
  double spring = 0.0;         // that pulls the joint to 0 [Nm/rad]; not part of robot descriptions
};

struct LinkInertia {
  double mass = 0.0;             // [kg]
  Vec3 p_LiCom = Vec3::Zero();   // centre of mass in L_i [m]
  Mat3 I_Com_Li = Mat3::Zero();  // about the centre of mass, in axes of L_i [kg m^2]
};

struct ArmModel {
  int num_joints = 0;
  std::array<Joint, kMaxJoints> joints{};
  std::array<LinkInertia, kMaxJoints> links{};
  Pose X_LnE;                 // end effector E (flange) in the last link's frame
  Vec3 g_B{0.0, 0.0, -9.81};  // gravity in B [m/s^2]
  hal::JointArray q_ready{};  // a posture far from limits and singularities
  ArmShape shape;
};

}  // namespace fovea::model
