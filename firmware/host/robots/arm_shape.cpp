// SPDX-License-Identifier: Apache-2.0
#include "firmware/host/robots/arm_shape.hpp"

#include <algorithm>
#include <random>

#include "firmware/core/model/kinematics.hpp"
#include "firmware/core/model/segments.hpp"

namespace fovea::robots {
namespace {

using model::ArmModel;
using model::ArmShape;
using model::Capsule;
using model::Vec3;

constexpr double kLinkRadius = 0.055;  // of a link without simple bodies [m]
constexpr int kPostures = 8192;        // number of random postures
constexpr double kNear = 0.05;         // a pair that never comes this near is left out [m]
constexpr double kTooNear = 0.02;      // also left out is a pair that is this near [m]
constexpr double kTooOften = 0.25;     // in this share of all postures
constexpr double kPi = 3.14159265358979323846;

double DistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  return model::NearestOfSegments(p, p, a, b).distance;
}

Vec3 NextJointOf(const ArmModel& arm, std::size_t body) {
  return body == static_cast<std::size_t>(arm.num_joints) ? arm.X_LnE.p : arm.joints[body].X_PJ.p;
}

// Uniform in each joint's range, or in a full turn for an endless joint. Uses no standard distribution, so
// every computer draws the same postures.
model::VecN RandomPosture(const ArmModel& arm, std::mt19937_64& bits) {
  model::VecN q(arm.num_joints);
  for (int i = 0; i < arm.num_joints; ++i) {
    const model::Joint& joint = arm.joints[static_cast<std::size_t>(i)];
    const bool endless = joint.type == model::JointType::kRevolute && joint.q_max - joint.q_min > 4.0 * kPi;
    const double low = endless ? -kPi : joint.q_min;
    const double high = endless ? kPi : joint.q_max;
    q[i] = low + (high - low) * 0x1p-53 * static_cast<double>(bits() >> 11U);
  }
  return q;
}

double GapOf(const ArmModel& arm, const model::ArmPoses& poses, const ArmShape::Pair& pair) {
  const Capsule& near = arm.shape.bodies[static_cast<std::size_t>(pair.near)];
  const Capsule& far = arm.shape.bodies[static_cast<std::size_t>(pair.far)];
  const model::Pose X_near =
      pair.near == 0 ? model::Pose{} : poses.X_BL[static_cast<std::size_t>(pair.near - 1)];
  const model::Pose& X_far = poses.X_BL[static_cast<std::size_t>(pair.far - 1)];
  return model::NearestOfSegments(X_near * near.p_LA, X_near * near.p_LB, X_far * far.p_LA, X_far * far.p_LB)
             .distance -
         near.radius - far.radius;
}

void FindPairs(ArmModel& arm) {
  struct Candidate {
    ArmShape::Pair pair;
    double least = HUGE_VAL;
    int too_near = 0;
  };
  std::vector<Candidate> candidates;
  for (int near = 0; near <= arm.num_joints; ++near) {
    for (int far = near + ArmShape::kNeighbours + 1; far <= arm.num_joints; ++far) {
      candidates.push_back({{near, far}});
    }
  }
  std::mt19937_64 bits(1);
  model::ArmPoses poses;
  for (int k = 0; k < kPostures && !candidates.empty(); ++k) {
    model::ComputePoses(arm, RandomPosture(arm, bits), poses);
    for (Candidate& candidate : candidates) {
      const double gap = GapOf(arm, poses, candidate.pair);
      candidate.least = std::min(candidate.least, gap);
      candidate.too_near += gap < kTooNear ? 1 : 0;
    }
  }
  arm.shape.num_pairs = 0;
  for (const Candidate& candidate : candidates) {
    if (candidate.least < kNear && candidate.too_near < kTooOften * kPostures) {
      arm.shape.pairs[static_cast<std::size_t>(arm.shape.num_pairs++)] = candidate.pair;
    }
  }
}

}  // namespace

Capsule CapsuleOfCylinder(const model::Pose& X_LS, double length, double radius) {
  const Vec3 half(0.0, 0.0, 0.5 * length);
  return {X_LS * Vec3(-half), X_LS * half, radius};
}

Capsule CapsuleOfBox(const model::Pose& X_LS, const Vec3& size) {
  Eigen::Index longest = 0;
  size.maxCoeff(&longest);
  Vec3 half = Vec3::Zero();
  half[longest] = 0.5 * size[longest];
  Vec3 across = 0.5 * size;
  across[longest] = 0.0;
  return {X_LS * Vec3(-half), X_LS * half, across.norm()};
}

Capsule Hold(const std::vector<Capsule>& parts) {
  if (parts.size() == 1) {
    return parts.front();
  }
  std::vector<Vec3> ends;
  for (const Capsule& part : parts) {
    ends.push_back(part.p_LA);
    ends.push_back(part.p_LB);
  }
  Capsule held = parts.front();
  for (const Vec3& a : ends) {
    for (const Vec3& b : ends) {
      if ((a - b).squaredNorm() > (held.p_LA - held.p_LB).squaredNorm()) {
        held.p_LA = a;
        held.p_LB = b;
      }
    }
  }
  for (const Capsule& part : parts) {
    for (const Vec3& end : {part.p_LA, part.p_LB}) {
      held.radius = std::max(held.radius, DistanceToSegment(end, held.p_LA, held.p_LB) + part.radius);
    }
  }
  return held;
}

void SetShape(const std::vector<std::vector<Capsule>>& parts, ArmModel& arm) {
  arm.shape = ArmShape{};
  for (std::size_t k = 0; k < parts.size(); ++k) {
    arm.shape.bodies[k] =
        parts[k].empty() ? Capsule{Vec3::Zero(), NextJointOf(arm, k), kLinkRadius} : Hold(parts[k]);
  }
  FindPairs(arm);
}

}  // namespace fovea::robots
