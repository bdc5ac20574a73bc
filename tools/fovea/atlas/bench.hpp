// The things on the simulated bench that stand high enough to come between a camera and a target.
//
// Theirs is the simulator's bench (sim/render/bench.cpp), of which the sampler needs no more than upright
// boxes; tests/tools/fovea/atlas_bench_test.cpp holds the two against each other.
#pragma once

#include <span>

#include "firmware/core/model/types.hpp"

namespace fovea::atlas {

// An upright box: centre [m] in B, size [m] along its own axes, turned by `yaw` [rad] about z.
struct BenchThing {
  model::Vec3 centre_B;
  model::Vec3 size;
  double yaw = 0.0;
};

// Whatever is higher than this above the table is one of them [m].
inline constexpr double kThingHeight = 0.03;

[[nodiscard]] std::span<const BenchThing> BenchThings();

// Whether a thing comes nearer than `clear` [m] to the segment from `a_B` to `b_B` [m]; corners count as if
// they stood out square.
[[nodiscard]] bool ThingInTheWay(const model::Vec3& a_B, const model::Vec3& b_B, double clear);

}  // namespace fovea::atlas
