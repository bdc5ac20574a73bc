// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/model/model.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "firmware/core/model/dynamics.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/host/config/program.hpp"
#include "firmware/host/robots/robot.hpp"
#include "firmware/host/robots/shipped_robots.hpp"
#include "tools/fovea/model/checks.hpp"
#include "tools/fovea/model/emit.hpp"

namespace fovea {
namespace {

using config::InputError;
using model::VecN;
using nlohmann::ordered_json;

constexpr int kCheckedStates = 500;
constexpr double kPrintedAsZero = 5e-5;  // smaller numbers are 0 with four decimals; printed without a sign

robots::Robot Load(const std::string& name) { return robots::LoadRobot(robots::FindRobot(name, "model")); }

// All quantities of one state.
struct State {
  VecN q;
  VecN dq;
  VecN ddq;
  model::Pose X_BE;
  model::Mat6N J_E;
  model::MatN M;
  VecN h;  // C dq + g
  VecN g;
  VecN tau;
};

State Compute(const model::ArmModel& arm, const std::vector<double>& at) {
  const auto n = static_cast<std::size_t>(arm.num_joints);
  if (!at.empty() && at.size() != n && at.size() != 2 * n && at.size() != 3 * n) {
    throw InputError(fmt::format("--at has {} numbers: {}, {} or {} are allowed (q, dq, ddq of {} joints)",
                                 at.size(), n, 2 * n, 3 * n, n));
  }
  const auto part = [&](std::size_t index) -> VecN {
    hal::JointArray v{};
    for (std::size_t i = 0; i < n && index * n + i < at.size(); ++i) {
      v[i] = at[index * n + i];
    }
    return model::ToVector(v, arm.num_joints);
  };
  State s;
  s.q = at.empty() ? model::ToVector(arm.q_ready, arm.num_joints) : part(0);
  s.dq = part(1);
  s.ddq = part(2);
  if (!s.q.allFinite() || !s.dq.allFinite() || !s.ddq.allFinite()) {
    throw InputError("--at: must be finite numbers");
  }
  model::ArmPoses poses;
  model::ComputePoses(arm, s.q, poses);
  model::ArmDynamics dynamics;
  model::ComputeDynamics(arm, poses, s.dq, dynamics);
  s.X_BE = poses.X_BE;
  model::ComputeJacobian(arm, poses, model::Pose{}, s.J_E);
  s.M = dynamics.M;
  s.g = dynamics.g;
  s.h = dynamics.Cdq + dynamics.g;
  model::InverseDynamics(arm, poses, s.dq, s.ddq, s.tau);
  return s;
}

// x, y, z, qw, qx, qy, qz.
std::vector<double> PoseNumbers(const model::Pose& X) {
  const Eigen::Quaterniond q(X.R);
  return {X.p.x(), X.p.y(), X.p.z(), q.w(), q.x(), q.y(), q.z()};
}

std::vector<double> Numbers(const VecN& v) {
  std::vector<double> numbers;
  for (const double x : v) {
    numbers.push_back(x);
  }
  return numbers;
}

template <typename Matrix>
std::vector<std::vector<double>> Rows(const Matrix& matrix) {
  std::vector<std::vector<double>> rows;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    std::vector<double>& row = rows.emplace_back();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
      row.push_back(matrix(i, j));
    }
  }
  return rows;
}

void PrintJson(const robots::Robot& robot, const State& s, const std::vector<ModelCheck>& checks) {
  ordered_json json;
  json["robot"] = robot.name;
  json["q"] = Numbers(s.q);
  json["dq"] = Numbers(s.dq);
  json["ddq"] = Numbers(s.ddq);
  json["X_BE"] = PoseNumbers(s.X_BE);
  json["J_E"] = Rows(s.J_E);
  json["M"] = Rows(s.M);
  json["h"] = Numbers(s.h);
  json["g"] = Numbers(s.g);
  json["tau"] = Numbers(s.tau);
  for (const ModelCheck& check : checks) {
    json["checks"].push_back(
        {{"what", check.what}, {"value", check.value}, {"unit", check.unit}, {"good", check.Good()}});
  }
  fmt::print("{}\n", json.dump(2));
}

double WithoutSignedZero(double x) { return std::fabs(x) < kPrintedAsZero ? 0.0 : x; }

void PrintRow(const char* name, const char* unit, const std::vector<double>& numbers) {
  fmt::print("  {:<5}", name);
  for (const double x : numbers) {
    fmt::print("{:10.4f}", WithoutSignedZero(x));
  }
  fmt::print("  {}\n", unit);
}

void PrintVector(const char* name, const char* unit, const VecN& v) { PrintRow(name, unit, Numbers(v)); }

template <typename Matrix>
void PrintMatrix(const char* name, const char* unit, const Matrix& matrix) {
  for (const std::vector<double>& row : Rows(matrix)) {
    PrintRow(name, unit, row);
    name = unit = "";  // printed in the first row only
  }
}

void PrintLimits(const robots::Robot& robot) {
  const model::ArmModel& arm = robot.model;
  fmt::print("  {:<3}{:<22}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}\n", "", "joint", "from", "to",
             "speed", "accel", "jerk", "torque", "rate", "viscous", "coulomb");
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::Joint& j = arm.joints[k];
    fmt::print("  {:<3}{:<22}{:>8.4f}{:>8.4f} {:>7.4g} {:>7.4g} {:>7.4g} {:>7.4g} {:>7.4g}{:>8.2g}{:>8.2g}\n",
               i + 1, robot.joint_names[k] + (j.type == model::JointType::kPrismatic ? " (slides)" : ""),
               j.q_min, j.q_max, j.dq_max, j.ddq_max, j.dddq_max, j.tau_max, j.dtau_max, j.viscous,
               j.coulomb);
  }
}

void PrintTable(const robots::Robot& robot, const State& s, const std::vector<ModelCheck>& checks) {
  double mass = 0.0;
  for (const model::LinkInertia& link : robot.model.links) {
    mass += link.mass;
  }
  config::PrintFitted(
      fmt::format("{}: {} joints from \"{}\" to \"{}\", {:.2f} kg in motion; rad, m, Nm, N, s", robot.name,
                  robot.model.num_joints, robot.base_link, robot.tip_link, mass),
      2);
  PrintLimits(robot);
  fmt::print("\n");
  PrintVector("q", "rad", s.q);
  PrintVector("dq", "rad/s", s.dq);
  PrintVector("ddq", "rad/s^2", s.ddq);
  std::vector<double> X = PoseNumbers(s.X_BE);
  std::transform(X.begin(), X.end(), X.begin(), WithoutSignedZero);
  fmt::print("  X_BE  p = ({:.4f}, {:.4f}, {:.4f}) m, q = (w {:.4f}, {:.4f}, {:.4f}, {:.4f})\n", X[0], X[1],
             X[2], X[3], X[4], X[5], X[6]);
  PrintMatrix("J_E", "linear, angular, in E", s.J_E);
  PrintMatrix("M", "kg m^2", s.M);
  PrintVector("h", "Nm, C dq + g", s.h);
  PrintVector("g", "Nm", s.g);
  PrintVector("tau", "Nm, M ddq + h", s.tau);
  fmt::print("\n  checks over {} random states\n", kCheckedStates);
  for (const ModelCheck& check : checks) {
    fmt::print("    {:<4} {:<44}{:10.2g} {:<8} at {} {:g}\n", check.Good() ? "ok" : "BAD", check.what,
               check.value, check.unit, check.at_least ? "least" : "most", check.bound);
  }
}

}  // namespace

CLI::App* AddModel(CLI::App& app, ModelArguments& arguments) {
  CLI::App* model = app.add_subcommand(
      "model",
      "print an arm's kinematics and dynamics: poses, Jacobian, M, C dq, g, torques, limits, checks");
  model->add_option("urdf", arguments.robot, "a shipped arm by name, or the path of an arm file or URDF")
      ->required();
  model
      ->add_option("--at", arguments.at,
                   "q, or q,dq, or q,dq,ddq, comma-separated; default: the ready posture")
      ->delimiter(',')
      ->allow_extra_args(false);
  CLI::Option* json =
      model->add_flag("--json", arguments.json, "print {q, dq, ddq, X_BE, J_E, M, h, g, tau, checks}");
  model->add_flag("--emit-cpp", arguments.emit_cpp, "print the model as a C++ header instead")
      ->excludes(json);
  model->footer(
      "Examples:\n"
      "  fovea model panda\n"
      "  fovea model my_arm.urdf --at 0,0.3,-1.2,0,0.5,0 --json\n"
      "  fovea model panda --emit-cpp > panda.hpp\n"
      "X_BE is x, y, z, qw, qx, qy, qz; h = C dq + g; tau = M ddq + h; matrices are lists of rows.\n"
      "Exit: 0 done, 1 a check of the model failed, 2 wrong usage or input.");
  return model;
}

int Model(const ModelArguments& arguments) {
  const robots::Robot robot = Load(arguments.robot);
  if (arguments.emit_cpp) {
    fmt::print("{}", EmitModel(robot));
    return config::kDone;
  }
  const State state = Compute(robot.model, arguments.at);
  const std::vector<ModelCheck> checks = CheckModel(robot.model, kCheckedStates);
  if (arguments.json) {
    PrintJson(robot, state, checks);
  } else {
    PrintTable(robot, state, checks);
  }
  for (const ModelCheck& check : checks) {
    if (!check.Good()) {
      return config::kGoalMissed;
    }
  }
  return config::kDone;
}

}  // namespace fovea
