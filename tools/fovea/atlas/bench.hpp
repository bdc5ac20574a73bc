// SPDX-License-Identifier: Apache-2.0
// The things on the simulated bench that are high enough to come between the camera and a target.
//
// The sampler approximates the things of the simulator's bench (sim/render/bench.cpp) by upright boxes.
// tests/tools/fovea/atlas_bench_test.cpp compares the two.
#pragma once

#include <span>
#include <vector>

#include "firmware/core/model/types.hpp"

namespace fovea::atlas {

// An upright box: centre [m] in B, size [m] along its own axes, turned by `yaw` [rad] about z.
struct BenchThing {
  model::Vec3 centre_B;
  model::Vec3 size;
  double yaw = 0.0;
};

// Things on the bench that are higher than this above the table are listed [m].
inline constexpr double kThingHeight = 0.03;

[[nodiscard]] std::span<const BenchThing> BenchThings();

// The upright boxes around the things, as the key safety.boxes has them, for a servo that is told what stands
// on its bench: low x, y, z, high x, y, z of each [m] in B.
[[nodiscard]] std::vector<double> BoxesOfThings();

// Whether the segment from `a_B` to `b_B` [m] meets a thing, enlarged by `clear` [m] on each side.
[[nodiscard]] bool ThingInTheWay(const model::Vec3& a_B, const model::Vec3& b_B, double clear);

}  // namespace fovea::atlas
