// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/tick/model_speed.hpp"

#include <functional>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <random>

#include "firmware/core/model/dynamics.hpp"
#include "tools/bench/common/spread.hpp"

namespace fovea::bench {
namespace {

constexpr int kStates = 500;
constexpr int kRounds = 41;

struct State {
  model::VecN q, dq, ddq;
  KDL::JntArray q_kdl, dq_kdl, ddq_kdl;
};

KDL::JntArray ToKdl(const model::VecN& v) {
  KDL::JntArray array(static_cast<unsigned>(v.size()));
  for (unsigned i = 0; i < array.rows(); ++i) {
    array(i) = v[static_cast<Eigen::Index>(i)];
  }
  return array;
}

std::vector<State> RandomStates(const model::ArmModel& arm) {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<State> states(kStates);
  for (State& s : states) {
    s.q = s.dq = s.ddq = model::VecN::Zero(arm.num_joints);
    for (int i = 0; i < arm.num_joints; ++i) {
      s.q[i] = 2.5 * unit(engine);
      s.dq[i] = 2.0 * unit(engine);
      s.ddq[i] = 10.0 * unit(engine);
    }
    s.q_kdl = ToKdl(s.q);
    s.dq_kdl = ToKdl(s.dq);
    s.ddq_kdl = ToKdl(s.ddq);
  }
  return states;
}

KDL::Chain ToKdl(const model::ArmModel& arm) {
  const auto frame = [](const model::Pose& X) {
    return KDL::Frame(KDL::Rotation(X.R(0, 0), X.R(0, 1), X.R(0, 2), X.R(1, 0), X.R(1, 1), X.R(1, 2),
                                    X.R(2, 0), X.R(2, 1), X.R(2, 2)),
                      KDL::Vector(X.p.x(), X.p.y(), X.p.z()));
  };
  KDL::Chain chain;
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::LinkInertia& link = arm.links[k];
    const KDL::Frame X = frame(arm.joints[k].X_PJ);
    const bool slides = arm.joints[k].type == model::JointType::kPrismatic;
    const model::Mat3& I = link.I_Com_Li;
    const KDL::RigidBodyInertia inertia(
        link.mass, KDL::Vector(link.p_LiCom.x(), link.p_LiCom.y(), link.p_LiCom.z()),
        KDL::RotationalInertia(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)));
    chain.addSegment(KDL::Segment(
        KDL::Joint(std::to_string(i), X.p, X.M.UnitZ(), slides ? KDL::Joint::TransAxis : KDL::Joint::RotAxis),
        X, inertia));
  }
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), frame(arm.X_LnE)));
  return chain;
}

using Call = std::function<void(const State&)>;

// For each of `calls`, run in turns: the median over rounds of the mean time per state [ns].
std::vector<double> Time(const std::vector<State>& states, const std::vector<Call>& calls) {
  std::vector<std::vector<double>> rounds(calls.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t c = 0; c < calls.size(); ++c) {
      rounds[c].push_back(MeanNs(states, calls[c]));
    }
  }
  std::vector<double> medians;
  medians.reserve(rounds.size());
  for (const std::vector<double>& values : rounds) {
    medians.push_back(Percentile(values, 0.5));
  }
  return medians;
}

}  // namespace

std::vector<Figure> ModelSpeed(const model::ArmModel& arm) {
  const std::vector<State> states = RandomStates(arm);
  const KDL::Chain chain = ToKdl(arm);
  const unsigned n = chain.getNrOfJoints();
  KDL::ChainFkSolverPos_recursive fk(chain);
  KDL::ChainJntToJacSolver jac(chain);
  KDL::ChainDynParam dynamics(chain, {arm.g_B.x(), arm.g_B.y(), arm.g_B.z()});
  KDL::ChainIdSolver_RNE inverse(chain, {arm.g_B.x(), arm.g_B.y(), arm.g_B.z()});
  KDL::Frame X_kdl;
  KDL::Jacobian J_kdl(n);
  KDL::JntSpaceInertiaMatrix M_kdl(static_cast<int>(n));
  KDL::JntArray C_kdl(n);
  KDL::JntArray g_kdl(n);
  KDL::JntArray tau_kdl(n);
  const KDL::Wrenches none(chain.getNrOfSegments(), KDL::Wrench::Zero());

  model::ArmPoses poses;
  model::Mat6N J;
  model::ArmDynamics ours;
  model::VecN tau;
  const auto kinematics = [&](const State& s) {
    model::ComputePoses(arm, s.q, poses);
    model::ComputeJacobian(arm, poses, model::Pose{}, J);
  };
  const auto kinematics_kdl = [&](const State& s) {
    fk.JntToCart(s.q_kdl, X_kdl);
    jac.JntToJac(s.q_kdl, J_kdl);
  };
  const std::vector<double> ns =
      Time(states, {[&](const State& s) {
                      kinematics(s);
                      model::ComputeDynamics(arm, poses, s.dq, ours);
                    },
                    [&](const State& s) {
                      kinematics_kdl(s);
                      dynamics.JntToMass(s.q_kdl, M_kdl);
                      dynamics.JntToCoriolis(s.q_kdl, s.dq_kdl, C_kdl);
                      dynamics.JntToGravity(s.q_kdl, g_kdl);
                    },
                    kinematics, kinematics_kdl,
                    [&](const State& s) {
                      model::ComputePoses(arm, s.q, poses);
                      model::InverseDynamics(arm, poses, s.dq, s.ddq, tau);
                    },
                    [&](const State& s) { inverse.CartToJnt(s.q_kdl, s.dq_kdl, s.ddq_kdl, none, tau_kdl); }});
  return {{"model_ns", ns[0], "ns", 1200.0},         {"model_kdl_ns", ns[1], "ns", {}},
          {"kinematics_ns", ns[2], "ns", {}},        {"kinematics_kdl_ns", ns[3], "ns", {}},
          {"inverse_dynamics_ns", ns[4], "ns", {}},  {"inverse_dynamics_kdl_ns", ns[5], "ns", {}},
          {"model_kdl_ratio", ns[1] / ns[0], "", {}}};
}

}  // namespace fovea::bench
