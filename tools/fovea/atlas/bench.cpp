// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/bench.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/core/model/rotation.hpp"

namespace fovea::atlas {
namespace {

const std::array<BenchThing, 3> kThings{{
    {{0.02, 0.50, 0.055}, {0.23, 0.16, 0.11}, 0.25},     // power supply, with its front
    {{0.05, -0.50, 0.025}, {0.13, 0.09, 0.05}, -0.2},    // box of parts
    {{0.99, -0.44, 0.0435}, {0.072, 0.072, 0.087}, 0.0}  // mug
}};

// Whether the segment meets the box, enlarged by `clear` (slab method).
bool Meets(const BenchThing& thing, const model::Vec3& a_B, const model::Vec3& b_B, double clear) {
  const model::Mat3 R_TB = model::RotationOf({0.0, 0.0, thing.yaw}).transpose();
  const model::Vec3 from = R_TB * (a_B - thing.centre_B);
  const model::Vec3 way = R_TB * (b_B - a_B);
  double enters = 0.0;
  double leaves = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = 0.5 * thing.size[axis] + clear;
    if (way[axis] == 0.0) {
      if (std::fabs(from[axis]) > half) {
        return false;
      }
      continue;
    }
    const double one = (-half - from[axis]) / way[axis];
    const double other = (half - from[axis]) / way[axis];
    enters = std::max(enters, std::min(one, other));
    leaves = std::min(leaves, std::max(one, other));
  }
  return enters <= leaves;
}

}  // namespace

std::span<const BenchThing> BenchThings() { return kThings; }

std::vector<double> BoxesOfThings() {
  std::vector<double> boxes;
  for (const BenchThing& thing : kThings) {
    const model::Mat3 R_BT = model::RotationOf({0.0, 0.0, thing.yaw});
    const model::Vec3 half = 0.5 * R_BT.cwiseAbs() * thing.size;
    for (const model::Vec3& corner :
         {model::Vec3(thing.centre_B - half), model::Vec3(thing.centre_B + half)}) {
      boxes.insert(boxes.end(), corner.begin(), corner.end());
    }
  }
  return boxes;
}

bool ThingInTheWay(const model::Vec3& a_B, const model::Vec3& b_B, double clear) {
  return std::any_of(kThings.begin(), kThings.end(),
                     [&](const BenchThing& thing) { return Meets(thing, a_B, b_B, clear); });
}

}  // namespace fovea::atlas
