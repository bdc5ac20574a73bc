// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/model/dynamics.hpp"

#include <array>

namespace fovea::model {
namespace {

// Twists and wrenches about the origin of B, in axes of B.
struct Twist {
  Vec3 v;  // of the body's point that is at the origin of B
  Vec3 w;
};
struct Wrench {
  Vec3 f;
  Vec3 n;  // moment about the origin of B
};

double Power(const Twist& S, const Wrench& F) noexcept { return S.v.dot(F.f) + S.w.dot(F.n); }

// The twist of joint i per unit of joint velocity.
Twist JointTwist(const ArmModel& model, const ArmPoses& poses, std::size_t i) noexcept {
  const Vec3 axis = poses.X_BL[i].R.col(2);
  if (model.joints[i].type == JointType::kRevolute) {
    return {Cross(poses.X_BL[i].p, axis), axis};
  }
  return {axis, Vec3::Zero()};
}

// Mass, first moment and inertia about the origin of B of a set of bodies.
struct Composite {
  double mass = 0.0;
  Vec3 h = Vec3::Zero();  // mass times centre of mass
  Mat3 I = Mat3::Zero();
};

// Link i: its centre of mass and its inertia about it, in B.
struct LinkInB {
  Vec3 p_com;
  Mat3 I_com;
};

LinkInB PlaceLink(const LinkInertia& link, const Pose& X_BL) noexcept {
  return {X_BL * link.p_LiCom, X_BL.R * link.I_Com_Li * X_BL.R.transpose()};
}

void AddLink(double mass, const LinkInB& link, Composite& sum) noexcept {
  const Vec3 h = mass * link.p_com;
  sum.mass += mass;
  sum.h += h;
  // Parallel axes: I about the origin = I_com + m (|c|^2 1 - c c^T).
  sum.I += link.I_com - h * link.p_com.transpose();
  sum.I.diagonal().array() += h.dot(link.p_com);
}

// Momentum of `body` moving with `V`; also the wrench that accelerates it by V from rest.
Wrench Momentum(const Composite& body, const Twist& V) noexcept {
  return {body.mass * V.v + Cross(V.w, body.h), body.I * V.w + Cross(body.h, V.v)};
}

// The torques of the links' motion. Wrenches are summed from the tip: F[i] acts through joint i. `A_0` is the
// acceleration of B (minus gravity, to include the arm's weight).
void NewtonEuler(const ArmModel& model, const std::array<Twist, kMaxJoints>& S,
                 const std::array<LinkInB, kMaxJoints>& links, const VecN& dq, const VecN* ddq,
                 const Vec3& A_0, VecN& tau) noexcept {
  std::array<Wrench, kMaxJoints> F;
  Twist V{Vec3::Zero(), Vec3::Zero()};
  Twist A{A_0, Vec3::Zero()};
  for (int i = 0; i < model.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Twist Sdq{S[k].v * dq[i], S[k].w * dq[i]};
    // dS/dt dq = V x S dq
    A.v += Cross(V.w, Sdq.v) + Cross(V.v, Sdq.w);
    A.w += Cross(V.w, Sdq.w);
    V.v += Sdq.v;
    V.w += Sdq.w;
    if (ddq != nullptr) {
      A.v += S[k].v * (*ddq)[i];
      A.w += S[k].w * (*ddq)[i];
    }
    // Newton and Euler at the centre of mass, then the moment about the origin of B.
    const Vec3& c = links[k].p_com;
    const Vec3 v_com = V.v + Cross(V.w, c);
    const Vec3 a_com = A.v + Cross(A.w, c) + Cross(V.w, v_com);
    F[k].f = model.links[k].mass * a_com;
    F[k].n = links[k].I_com * A.w + Cross(V.w, links[k].I_com * V.w) + Cross(c, F[k].f);
  }
  tau.resize(model.num_joints);
  for (int i = model.num_joints - 1; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    tau[i] = Power(S[k], F[k]);
    if (i > 0) {
      F[k - 1].f += F[k].f;
      F[k - 1].n += F[k].n;
    }
  }
}

void PlaceAll(const ArmModel& model, const ArmPoses& poses, std::array<Twist, kMaxJoints>& S,
              std::array<LinkInB, kMaxJoints>& links) noexcept {
  for (int i = 0; i < model.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    S[k] = JointTwist(model, poses, k);
    links[k] = PlaceLink(model.links[k], poses.X_BL[k]);
  }
}

}  // namespace

void ComputeDynamics(const ArmModel& model, const ArmPoses& poses, const VecN& dq,
                     ArmDynamics& dynamics) noexcept {
  const int n = model.num_joints;
  std::array<Twist, kMaxJoints> S;
  std::array<LinkInB, kMaxJoints> links;
  PlaceAll(model, poses, S, links);

  // M and g: link i and all beyond it move as one body when joint i alone moves.
  dynamics.M.resize(n, n);
  dynamics.g.resize(n);
  Composite body;
  for (int j = n - 1; j >= 0; --j) {
    const auto k = static_cast<std::size_t>(j);
    AddLink(model.links[k].mass, links[k], body);
    const Wrench F = Momentum(body, S[k]);
    for (int i = 0; i <= j; ++i) {
      const double m = Power(S[static_cast<std::size_t>(i)], F);
      dynamics.M(i, j) = m;
      dynamics.M(j, i) = m;
    }
    dynamics.M(j, j) += model.joints[k].rotor_inertia;
    const Wrench weight{body.mass * model.g_B, Cross(body.h, model.g_B)};
    dynamics.g[j] = -Power(S[k], weight);
  }

  NewtonEuler(model, S, links, dq, nullptr, Vec3::Zero(), dynamics.Cdq);
}

void InverseDynamics(const ArmModel& model, const ArmPoses& poses, const VecN& dq, const VecN& ddq,
                     VecN& tau) noexcept {
  std::array<Twist, kMaxJoints> S;
  std::array<LinkInB, kMaxJoints> links;
  PlaceAll(model, poses, S, links);
  NewtonEuler(model, S, links, dq, &ddq, -model.g_B, tau);
  for (int i = 0; i < model.num_joints; ++i) {
    tau[i] += model.joints[static_cast<std::size_t>(i)].rotor_inertia * ddq[i];
  }
}

}  // namespace fovea::model
