// SPDX-License-Identifier: Apache-2.0
// ViSP's visual laws behind plain arrays, because its headers need C++17.
#pragma once

#include <array>

namespace fovea::test {

enum class VispLaw { kIbvs, kMean, kDesired, kPbvs, kHybrid };

// A plate in front of the camera.
struct VispView {
  std::array<std::array<double, 3>, 4> p_CP_C{};  // of each corner [m]
  std::array<double, 16> X_CO{};                  // [4 x 4], row by row
};

// The camera's twist [v; w], in axes of C, that vpServo computes. `lambda` [1/s].
std::array<double, 6> VispTwist(VispLaw law, const VispView& now, const VispView& goal, double lambda);

}  // namespace fovea::test
