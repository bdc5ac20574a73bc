// SPDX-License-Identifier: Apache-2.0
// The next motion of a predictive law: model predictive control of the picture.
//
// A horizon is a plan of fixed duration: the uniform cubic B-spline of trajectory::Plan. Its first three
// control points follow from the joints' motion at the start, its last three are one point, so that it ends
// at rest. The points between, c, are chosen:
//
//   minimise    sum_k |s(q_k, t_k) - s_star|^2 + (a little of) the squared velocities and accelerations
//   subject to  |c_(i+1) - c_i| <= T V,   |c_(i+2) - 2 c_(i+1) + c_i| <= T^2 A,   c_i in the joints' ranges,
//               h(q_k) >= margin for the picture's sides, workspace, planes, boxes and the arm's own links
//
// with q_k the joints at the knots. The target goes on with its velocity. A spline lies within its
// differences, so that the first two rows bound velocity and acceleration at all times; the period T is long
// enough that they bound the jerk, too. A few steps of Gauss and Newton, each a quadratic program with the
// rows linearised. (Allibert, Courtial and Chaumette, Predictive control for constrained image-based visual
// servoing, IEEE T-RO 2010.)
//
// Nothing is proved here: a horizon is a wish like a law's, and the tick keeps all limits.
#pragma once

#include "firmware/core/barriers/solid_barriers.hpp"
#include "firmware/core/trajectory/plan.hpp"
#include "firmware/core/trajectory/plan_request.hpp"
#include "firmware/planning/horizon_program.hpp"
#include "firmware/planning/path_speed.hpp"
#include "firmware/planning/work.hpp"

namespace fovea::planning {

class HorizonSearch {
 public:
  // `config` must outlive this.
  explicit HorizonSearch(const config::ServoConfig& config);

  // Fills in the control points of `plan`, whose other fields the caller has set. kFound, or the reason why
  // there are none. The same request has the same answer.
  [[nodiscard]] trajectory::PlanOutcome Search(const trajectory::PlanRequest& request, Work& work,
                                               trajectory::Plan& plan) noexcept;

 private:
  // What the camera sees at a knot.
  struct Knot {
    features::FeatureVector e;  // s - s_star
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, features::kMaxDim,
                  model::kMaxJoints>
        J;  // [dim x num_joints] de/dq
  };

  void Begin(const trajectory::PlanRequest& request) noexcept;
  [[nodiscard]] model::VecN At(const Eigen::VectorXd& c, int knot) const noexcept;
  [[nodiscard]] double Cost(const Eigen::VectorXd& c, Work& work) noexcept;
  void Linearise(const Eigen::VectorXd& c, Work& work) noexcept;
  void AddMotion(const Eigen::VectorXd& c) noexcept;
  void AddKnot(const Eigen::VectorXd& c, int knot, Work& work) noexcept;
  void AddBarrier(int knot, const barriers::Barrier& barrier, double room) noexcept;
  [[nodiscard]] bool See(const model::VecN& q, int knot, Knot& seen) const noexcept;
  [[nodiscard]] features::TargetInCamera TargetAt(const model::Pose& X_BC, int knot) const noexcept;
  [[nodiscard]] model::VecN Point(const Eigen::VectorXd& c, int i) const noexcept;

  const config::ServoConfig& config_;
  const int num_joints_;
  const JointLimits limits_;
  const double period_s_;
  barriers::SolidBarriers solid_;
  features::TargetOutline outline_;
  HorizonProgram program_;
  Eigen::VectorXd c_;  // the free control points, one after another
  Eigen::VectorXd trial_;
  std::array<model::VecN, 3> first_;  // the fixed ones
  model::Pose X_BO_;
  model::Vec3 v_BO_ = model::Vec3::Zero();
  model::VecN q_off_;
};

}  // namespace fovea::planning
