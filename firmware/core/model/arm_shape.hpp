// SPDX-License-Identifier: Apache-2.0
// The space that an arm fills: a capsule about each link, and the pairs of capsules that could touch.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/core/model/types.hpp"

namespace fovea::model {

// All points within `radius` of the segment from A to B, both in the frame of the body's link.
struct Capsule {
  Vec3 p_LA = Vec3::Zero();  // [m]
  Vec3 p_LB = Vec3::Zero();  // [m]
  double radius = 0.0;       // [m]
};

struct ArmShape {
  static constexpr int kMostBodies = kMaxJoints + 1;
  static constexpr int kNeighbours = 2;  // bodies with at most this many joints between them are always near
  static constexpr int kMostPairs = (kMaxJoints - kNeighbours) * (kMaxJoints - kNeighbours + 1) / 2;

  // Two bodies; `far` is further from the base.
  struct Pair {
    std::int32_t near = 0;
    std::int32_t far = 0;
  };

  std::array<Capsule, kMostBodies> bodies{};  // 0: the base, in B; i + 1: link i, in L_i
  int num_pairs = 0;                          // of bodies that could touch
  std::array<Pair, kMostPairs> pairs{};
};

}  // namespace fovea::model
