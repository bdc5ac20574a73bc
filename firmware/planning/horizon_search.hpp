// SPDX-License-Identifier: Apache-2.0
// The next motion of a predictive law: model predictive control of the picture.
//
// A horizon is a plan of fixed duration: the uniform cubic B-spline of trajectory::Plan, with period T. Its
// first three control points follow from the joints' motion at the start, its last three are one point, so
// that it ends at rest. The points between, c, are chosen:
//
//   minimise    sum_k |e_k|^2 + |de/dt_k|^2 / lambda^2
//
//               and a little of the joints' squared accelerations, and of their squared velocities in
//               directions that the feature leaves free,
//
//   subject to  differences of c: |first| <= T V,   |second| <= T^2 A,   |third| <= T^3 J,
//
//               c in the joints' ranges,   h(q_k) >= margin
//
// with q_k the joints at the knots, e_k = s(q_k, t_k) - s_star, and the law's gain lambda: without limits, e
// decays like exp(-lambda t), as with the other laws. The limits V, A and J hold at all times, because a
// spline's derivatives are means of these differences. h are the picture's sides, workspace, planes, boxes
// and the arm's own links. The target goes on with its velocity. The arm is where its reference was a lag
// ago.
//
// Each of a few steps of Gauss and Newton is a quadratic program with the rows linearised. (Allibert,
// Courtial and Chaumette, Predictive control for constrained image-based visual servoing, IEEE T-RO 2010.)
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
    double size = 1.0;              // of the goal
    features::FeatureVector e;      // s - s_star, as a share of the goal's size
    features::FeatureVector drift;  // de/dt from the target's own motion [1/s]
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, features::kMaxDim,
                  model::kMaxJoints>
        J;          // [dim x num_joints] de/dq
    model::MatN N;  // projects on the directions that leave e as it is
  };

  // A knot's part of the sum, e^T e + rate^T rate / lambda^2 + dq^T N dq, as quadratic forms of the joints
  // there and of their velocities.
  struct Form {
    std::array<double, 3> share;  // of the knot's control points
    double value;                 // of the sum
    model::VecN g;                // half its gradient
    model::MatN G;                // half its second derivative
  };
  [[nodiscard]] std::array<Form, 2> FormsAt(const Eigen::VectorXd& c, int knot,
                                            const Knot& seen) const noexcept;

  void Begin(const trajectory::PlanRequest& request) noexcept;
  [[nodiscard]] model::VecN At(const Eigen::VectorXd& c, int knot) const noexcept;
  [[nodiscard]] model::VecN Sum(const Eigen::VectorXd& c, int knot,
                                const std::array<double, 3>& share) const noexcept;
  // Shares of a knot's control points in the joints as they are then, a lag behind the reference.
  [[nodiscard]] std::array<double, 3> PlaceShares() const noexcept;
  [[nodiscard]] double Cost(const Eigen::VectorXd& c, Work& work) noexcept;
  void Linearise(const Eigen::VectorXd& c, Work& work) noexcept;
  void AddMotion(const Eigen::VectorXd& c) noexcept;
  void AddKnot(const Eigen::VectorXd& c, int knot, Work& work) noexcept;
  void AddBarrier(int knot, const barriers::Barrier& barrier) noexcept;
  [[nodiscard]] bool See(const model::VecN& q, int knot, Knot& seen) const noexcept;
  [[nodiscard]] features::TargetInCamera TargetAt(const model::Pose& X_BC, int knot) const noexcept;
  [[nodiscard]] model::VecN Point(const Eigen::VectorXd& c, int i) const noexcept;

  const config::ServoConfig& config_;
  const int num_joints_;
  const JointLimits limits_;
  barriers::SolidBarriers solid_;
  features::TargetOutline outline_;
  HorizonProgram program_;
  Eigen::VectorXd c_;  // the free control points, one after another
  Eigen::VectorXd trial_;
  std::array<model::VecN, 3> first_;  // the fixed ones
  int turn_ = 0;                      // equal turn of the target that is nearest to its goal
  model::Pose X_BO_;                  // with this turn
  model::Vec3 v_BO_ = model::Vec3::Zero();
  model::VecN q_off_;   // [num_joints] of the measured joints from where the reference was a lag ago
  double lag_s_ = 0.0;  // of the arm behind its reference
  double gain_ = 1.0;   // lambda [1/s]
};

}  // namespace fovea::planning
