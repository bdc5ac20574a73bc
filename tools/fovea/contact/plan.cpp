// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/contact/plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "firmware/core/model/kinematics.hpp"
#include "tools/fovea/atlas/uniform.hpp"

namespace fovea::contact {
namespace {

constexpr double kMassError = 0.2;
constexpr double kFrictionError = 0.5;
constexpr double kLoadLess = 0.2;  // [kg]
constexpr double kLoadMore = 0.3;
constexpr int kElbowJoint =
    4;  // the elbow is the origin of its link: only this many joints feel a push there

}  // namespace

std::span<const Motion> Motions() {
  static const std::array<Motion, 4> kMotions{
      Motion{"home", "home", {}, 4.0, {0.4, 1.0}}, Motion{"circle", "flange-circle", {}, 9.0, {0.8, 7.0}},
      Motion{"waves",
             "flange-circle",
             {R"(motion.kind="waves")", "motion.omega=1.5", "motion.multiple=[1, 2, 1, 1, 2, 1, 2]",
              "motion.amplitude=[0.3, 0.12, 0.3, 0.2, 0.3, 0.2, 0.5]"},
             30.0,
             {2.0, 8.0}},
      Motion{"track", "ball-moving", {}, 8.0, {0.5, 6.0}}};
  return kMotions;
}

const char* Name(Place place) { return place == Place::kHand ? "hand" : "elbow"; }

std::vector<std::string> WrongBeliefs(std::mt19937_64& random, int draw, int num_joints) {
  std::vector<double> masses;
  for (int i = 0; i < num_joints; ++i) {
    const double drawn = atlas::Uniform(random, 1.0 - kMassError, 1.0 + kMassError);
    masses.push_back(draw == 0 ? 1.0 + kMassError : draw == 1 ? 1.0 - kMassError : drawn);
  }
  const double load = atlas::Uniform(random, -kLoadLess, kLoadMore);
  const double viscous = atlas::Uniform(random, 1.0 - kFrictionError, 1.0 + kFrictionError);
  const double coulomb = atlas::Uniform(random, 1.0 - kFrictionError, 1.0 + kFrictionError);
  return {fmt::format("truth.arm.link_mass.scale=[{:.4f}]", fmt::join(masses, ", ")),
          fmt::format("truth.arm.load_mass.offset={:.4f}", load),
          fmt::format("truth.arm.viscous.scale={:.4f}", viscous),
          fmt::format("truth.arm.coulomb.scale={:.4f}", coulomb)};
}

Push DrawPush(std::mt19937_64& random, Place place, const Motion& motion) {
  Push push;
  push.place = place;
  // Uniform on the sphere: the height is uniform, and so is the angle about it.
  const double z = atlas::Uniform(random, -1.0, 1.0);
  const double angle = atlas::Uniform(random, -M_PI, M_PI);
  const double across = std::sqrt(1.0 - z * z);
  push.direction_B = {across * std::cos(angle), across * std::sin(angle), z};
  push.from_s = std::round(1e3 * atlas::Uniform(random, motion.pushed_s[0], motion.pushed_s[1])) * 1e-3;
  return push;
}

std::vector<std::string> AssignmentsOf(const Push& push, double force, const model::ArmModel& arm,
                                       const std::vector<double>& q) {
  model::VecN posture(arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    posture[i] = q.at(static_cast<std::size_t>(i));
  }
  model::ArmPoses poses;
  model::ComputePoses(arm, posture, poses);
  const int joints = push.place == Place::kHand ? arm.num_joints : std::min(kElbowJoint, arm.num_joints);
  const model::Vec3 p_B =
      push.place == Place::kHand ? poses.X_BE.p : poses.X_BL.at(static_cast<std::size_t>(joints - 1)).p;
  model::LinearJacobian J;
  model::ComputeLinearJacobian(arm, poses, p_B, J);
  std::vector<double> torques(static_cast<std::size_t>(arm.num_joints), 0.0);
  for (int i = 0; i < joints; ++i) {
    torques[static_cast<std::size_t>(i)] = force * J.col(i).dot(push.direction_B);
  }
  return {fmt::format("faults.push=[{:.4f}]", fmt::join(torques, ", ")),
          fmt::format("faults.push_s=[{:.3f}, {:.3f}]", push.from_s, push.from_s + kPushS)};
}

}  // namespace fovea::contact
