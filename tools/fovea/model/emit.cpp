// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/model/emit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <vector>

namespace fovea {
namespace {

// Makes an identifier from any text: "ur5e" from "ur5e", "my_arm" from "my arm", "arm_3x" from "3x".
std::string Identifier(const std::string& name) {
  std::string id;
  for (const char c : name) {
    id += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  return id.empty() || std::isdigit(static_cast<unsigned char>(id.front())) != 0 ? "arm_" + id : id;
}

// "MyArm" from "my_arm".
std::string CamelCase(const std::string& id) {
  std::string camel;
  bool starts_word = true;
  for (const char c : id) {
    if (c != '_') {
      camel += starts_word ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    }
    starts_word = c == '_';
  }
  return camel;
}

// Hexadecimal, which is exact.
std::string Number(double value) { return fmt::format("{:a}", value); }

template <typename Matrix>
std::string Row(const Matrix& matrix) {
  std::string text;
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index col = 0; col < matrix.cols(); ++col) {
      text += (text.empty() ? "" : ", ") + Number(matrix(row, col));
    }
  }
  return text;
}

std::string JointRow(const model::Joint& joint) {
  std::string text = fmt::format("    {{{}, {{{}}}, {{{}}}, {{", joint.type == model::JointType::kPrismatic,
                                 Row(joint.X_PJ.R), Row(joint.X_PJ.p));
  const std::vector<double> values{joint.q_min,    joint.q_max,         joint.dq_max,   joint.ddq_max,
                                   joint.dddq_max, joint.tau_max,       joint.dtau_max, joint.viscous,
                                   joint.coulomb,  joint.rotor_inertia, joint.spring};
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += (i == 0 ? "" : ", ") + Number(values[i]);
  }
  return text + "}";
}

std::string BodyRows(const model::ArmModel& arm) {
  std::string text;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(arm.num_joints); ++k) {
    const model::Capsule& body = arm.shape.bodies[k];
    text += fmt::format("    {{{}, {}, {}}},\n", Row(body.p_LA), Row(body.p_LB), Number(body.radius));
  }
  return text;
}

std::string PairRows(const model::ArmShape& shape) {
  std::string text;
  for (std::size_t k = 0; k < static_cast<std::size_t>(shape.num_pairs); ++k) {
    text += fmt::format("{}{{{}, {}}}", k == 0 ? "" : ", ", shape.pairs[k].near, shape.pairs[k].far);
  }
  return text.empty() ? "{0, 0}" : text;
}

}  // namespace

std::string EmitModel(const robots::Robot& robot) {
  const model::ArmModel& arm = robot.model;
  const std::string id = Identifier(robot.name);
  std::string text = fmt::format(
      "// The arm \"{0}\", {1} joints from \"{2}\" to \"{3}\". Written by `fovea model {0} --emit-cpp`; do "
      "not\n"
      "// change it by hand. Numbers are hexadecimal, exact to the last bit.\n"
      "#pragma once\n\n"
      "#include <iterator>\n\n"
      "#include \"fovea/arm_model.hpp\"\n\n"
      "namespace fovea::arms {{\n"
      "namespace {0}_data {{\n\n"
      "struct JointData {{\n"
      "  bool prismatic;\n"
      "  double R_PJ[9];  // row by row\n"
      "  double p_PJ[3];\n"
      "  double limits[11];  // q_min, q_max, dq, ddq, dddq, tau, dtau; viscous, coulomb, rotor, spring\n"
      "  double mass;\n"
      "  double p_LiCom[3];\n"
      "  double I_Com_Li[9];  // row by row\n"
      "  double q_ready;\n"
      "}};\n\n"
      "inline constexpr JointData kJoints[{1}] = {{\n",
      id, arm.num_joints, robot.base_link, robot.tip_link);
  for (int i = 0; i < arm.num_joints; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::LinkInertia& link = arm.links[k];
    text += fmt::format("{}, {}, {{{}}}, {{{}}}, {}}},\n", JointRow(arm.joints[k]), Number(link.mass),
                        Row(link.p_LiCom), Row(link.I_Com_Li), Number(arm.q_ready[k]));
  }
  const std::string bodies = BodyRows(arm);
  const std::string pairs = PairRows(arm.shape);
  text += fmt::format(
      "}};\n"
      "// Capsules around the base and around each link: two ends and the radius.\n"
      "inline constexpr double kBodies[{7}][7] = {{\n{6}}};\n"
      "inline constexpr int kPairs[{9}][2] = {{{8}}};\n"
      "inline constexpr double kFlangeR[9] = {{{1}}};\n"
      "inline constexpr double kFlangeP[3] = {{{2}}};\n"
      "inline constexpr double kGravity[3] = {{{3}}};\n\n"
      "}}  // namespace {0}_data\n\n"
      "// Sets `arm` to this model.\n"
      "inline void Load{5}(model::ArmModel& arm) noexcept {{\n"
      "  using namespace {0}_data;\n"
      "  using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;\n"
      "  arm = model::ArmModel{{}};\n"
      "  arm.num_joints = {4};\n"
      "  for (int i = 0; i < arm.num_joints; ++i) {{\n"
      "    const auto k = static_cast<std::size_t>(i);\n"
      "    const JointData& data = kJoints[k];\n"
      "    model::Joint& joint = arm.joints[k];\n"
      "    joint.type = data.prismatic ? model::JointType::kPrismatic : model::JointType::kRevolute;\n"
      "    joint.X_PJ = {{Eigen::Map<const RowMajor>(data.R_PJ), Eigen::Map<const "
      "model::Vec3>(data.p_PJ)}};\n"
      "    joint.q_min = data.limits[0];\n"
      "    joint.q_max = data.limits[1];\n"
      "    joint.dq_max = data.limits[2];\n"
      "    joint.ddq_max = data.limits[3];\n"
      "    joint.dddq_max = data.limits[4];\n"
      "    joint.tau_max = data.limits[5];\n"
      "    joint.dtau_max = data.limits[6];\n"
      "    joint.viscous = data.limits[7];\n"
      "    joint.coulomb = data.limits[8];\n"
      "    joint.rotor_inertia = data.limits[9];\n"
      "    joint.spring = data.limits[10];\n"
      "    arm.links[k] = {{data.mass, Eigen::Map<const model::Vec3>(data.p_LiCom),\n"
      "                    Eigen::Map<const RowMajor>(data.I_Com_Li)}};\n"
      "    arm.q_ready[k] = data.q_ready;\n"
      "  }}\n"
      "  arm.X_LnE = {{Eigen::Map<const RowMajor>(kFlangeR), Eigen::Map<const model::Vec3>(kFlangeP)}};\n"
      "  arm.g_B = Eigen::Map<const model::Vec3>(kGravity);\n"
      "  for (std::size_t k = 0; k < std::size(kBodies); ++k) {{\n"
      "    arm.shape.bodies[k] = {{Eigen::Map<const model::Vec3>(kBodies[k]),\n"
      "                           Eigen::Map<const model::Vec3>(kBodies[k] + 3), kBodies[k][6]}};\n"
      "  }}\n"
      "  arm.shape.num_pairs = {10};\n"
      "  for (std::size_t k = 0; k < static_cast<std::size_t>(arm.shape.num_pairs); ++k) {{\n"
      "    arm.shape.pairs[k] = {{kPairs[k][0], kPairs[k][1]}};\n"
      "  }}\n"
      "}}\n\n"
      "}}  // namespace fovea::arms\n",
      id, Row(arm.X_LnE.R), Row(arm.X_LnE.p), Row(arm.g_B), arm.num_joints, CamelCase(id), bodies,
      arm.num_joints + 1, pairs, std::max(arm.shape.num_pairs, 1), arm.shape.num_pairs);
  return text;
}

}  // namespace fovea
