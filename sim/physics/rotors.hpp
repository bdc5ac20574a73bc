// SPDX-License-Identifier: Apache-2.0
// The motors' rotors, which Bullet's multi-body does not have.
//
// With rotors of inertia I_r, seen at the joints, an arm obeys (M + I_r) ddq = tau - h. Bullet solves
// M ddq = tau' - h. Both give the same ddq for tau' = tau - I_r ddq, so a step of Bullet under tau' is a step
// of the arm with rotors. Coulomb friction that holds a joint is solved here, too, with the inertia of links
// and rotors. Only the impulses of contacts are Bullet's: they move the joints as if there were no rotors.
#pragma once

#include <Eigen/LU>

#include "sim/physics/integrator.hpp"
#include "sim/physics/multi_body_joints.hpp"

namespace fovea::sim {

// A step of the arm with rotors, made of a semi-implicit Euler step of Bullet.
struct RotorStep {
  Eigen::VectorXd tau;       // for Bullet [Nm, N]
  Eigen::VectorXd shift;     // to be added to the joints' positions afterwards [rad, m]
  Eigen::VectorXd stiction;  // torques of the friction that holds [Nm, N]
};

class Rotors {
 public:
  // `inertia` [num_dofs; kg m^2, kg] >= 0. `joints` must outlive it.
  Rotors(Eigen::VectorXd inertia, Integrator integrator, MultiBodyJoints& joints);

  // See BulletArm::SetStiction.
  void SetStiction(const Eigen::VectorXd& coulomb) { coulomb_ = coulomb; }

  // Under the torques `tau` [num_dofs; Nm, N] and gravity `g` in B [m/s^2]. Keep the state.
  [[nodiscard]] Eigen::VectorXd Acceleration(const Eigen::VectorXd& tau, const btVector3& g);
  [[nodiscard]] RotorStep Plan(const Eigen::VectorXd& tau, const btVector3& g, double dt);

  // Kinetic energy of the rotors [J].
  [[nodiscard]] double Energy() const;

 private:
  // Solves (1 + A I_r) x = b, where A is the inverse of the links' mass matrix.
  [[nodiscard]] Eigen::PartialPivLU<Eigen::MatrixXd> WithRotors(const Eigen::MatrixXd& A) const;

  Eigen::VectorXd inertia_;
  Integrator integrator_;
  Eigen::VectorXd coulomb_;  // [Nm, N]; empty: no friction that holds
  MultiBodyJoints& joints_;
};

}  // namespace fovea::sim
