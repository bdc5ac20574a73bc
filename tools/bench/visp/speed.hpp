// SPDX-License-Identifier: Apache-2.0
// Speed of the visual law and of ViSP's, on the same points.
#pragma once

#include <vector>

#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// From four points and their depths (eight features) to the camera's twist by the pseudo-inverse: s,
// L_s [8 x 6], the error and the law, on both sides. The rounds alternate. Returns medians [ns per call] and
// ratios. `visp_control_law`: ViSP's usual call, which also projects a secondary task. `visp_steps`: only
// L_s, the error and the pseudo-inverse by ViSP. std::runtime_error when the two twists differ.
std::vector<Figure> VispSpeed();

}  // namespace fovea::bench
