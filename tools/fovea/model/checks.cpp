// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/model/checks.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "firmware/core/model/dynamics.hpp"

namespace fovea {
namespace {

using model::ArmDynamics;
using model::ArmModel;
using model::ArmPoses;
using model::VecN;

constexpr double kStep = 1e-5;     // of central differences [rad, m]
constexpr double kFullTurn = 3.2;  // largest tested |q| of a joint without limits [rad]

ArmPoses PosesAt(const ArmModel& arm, const VecN& q) {
  ArmPoses poses;
  model::ComputePoses(arm, q, poses);
  return poses;
}

ArmDynamics DynamicsAt(const ArmModel& arm, const VecN& q, const VecN& dq) {
  ArmDynamics dynamics;
  model::ComputeDynamics(arm, PosesAt(arm, q), dq, dynamics);
  return dynamics;
}

// -sum m g . p over the links [J].
double PotentialEnergy(const ArmModel& arm, const VecN& q) {
  const ArmPoses poses = PosesAt(arm, q);
  double energy = 0.0;
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    energy -= arm.links[k].mass * arm.g_B.dot(poses.X_BL[k] * arm.links[k].p_LiCom);
  }
  return energy;
}

VecN Moved(const VecN& q, int joint, double by) {
  VecN moved = q;
  moved[joint] += by;
  return moved;
}

struct Worst {
  double eigenvalue = HUGE_VAL;
  double asymmetry = 0.0;
  double gravity = 0.0;
  double power = 0.0;
  double jacobian = 0.0;
};

void LookAt(const ArmModel& arm, const VecN& q, const VecN& dq, Worst& worst) {
  const ArmDynamics dynamics = DynamicsAt(arm, q, dq);
  const Eigen::MatrixXd M = dynamics.M;
  worst.asymmetry = std::max(worst.asymmetry, (M - M.transpose()).cwiseAbs().maxCoeff());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(M, Eigen::EigenvaluesOnly);
  worst.eigenvalue = std::min(worst.eigenvalue, solver.eigenvalues()[0]);

  model::Mat6N J;
  const ArmPoses poses = PosesAt(arm, q);
  model::ComputeBaseJacobian(arm, poses, J);
  for (int i = 0; i < arm.num_joints; ++i) {
    const VecN above = Moved(q, i, kStep);
    const VecN below = Moved(q, i, -kStep);
    const double slope = (PotentialEnergy(arm, above) - PotentialEnergy(arm, below)) / (2.0 * kStep);
    worst.gravity = std::max(worst.gravity, std::fabs(slope - dynamics.g[i]));
    const model::Pose up = PosesAt(arm, above).X_BE;
    const model::Pose down = PosesAt(arm, below).X_BE;
    const model::Vec3 v = (up.p - down.p) / (2.0 * kStep);
    const model::Mat3 turn = (up.R - down.R) / (2.0 * kStep) * poses.X_BE.R.transpose();
    worst.jacobian = std::max({worst.jacobian, (J.col(i).head<3>() - v).cwiseAbs().maxCoeff(),
                               (model::CrossMatrix(J.col(i).tail<3>()) - turn).cwiseAbs().maxCoeff()});
  }
  // The work of the Coriolis terms equals that of the change of M: dq . (dM/dt dq / 2 - C dq) = 0.
  const VecN ahead = q + kStep * dq;
  const VecN behind = q - kStep * dq;
  const Eigen::MatrixXd dM = (DynamicsAt(arm, ahead, dq).M - DynamicsAt(arm, behind, dq).M) / (2.0 * kStep);
  const double power = 0.5 * dq.dot(dM * dq) - dq.dot(dynamics.Cdq);
  worst.power = std::max(worst.power, std::fabs(power));
}

}  // namespace

std::vector<ModelCheck> CheckModel(const ArmModel& arm, int states) {
  std::mt19937_64 engine(1);
  Worst worst;
  for (int k = 0; k < states; ++k) {
    VecN q(arm.num_joints);
    VecN dq(arm.num_joints);
    for (int i = 0; i < arm.num_joints; ++i) {
      const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
      q[i] = std::uniform_real_distribution<double>(std::max(joint.q_min, -kFullTurn),
                                                    std::min(joint.q_max, kFullTurn))(engine);
      dq[i] = std::uniform_real_distribution<double>(-1.0, 1.0)(engine);
    }
    LookAt(arm, q, dq, worst);
  }
  return {{"smallest eigenvalue of M", worst.eigenvalue, "kg m^2", 1e-9, /*at_least=*/true},
          {"M minus its transpose", worst.asymmetry, "kg m^2", 1e-10},
          {"g minus the slope of the potential energy", worst.gravity, "Nm", 1e-5},
          {"power of C dq minus that of dM/dt", worst.power, "W", 1e-5},
          {"J_E minus the slope of X_BE", worst.jacobian, "", 1e-7}};
}

}  // namespace fovea
