// The visual law beside ViSP's, on the same points.
#pragma once

#include <vector>

#include "tools/bench/common/figure.hpp"

namespace fovea::bench {

// Four points and their depths, eight features, to the camera's twist by the pseudo-inverse: s, L_s [8 x 6],
// the error and the law, all of it on both sides. Rounds of both take turns; medians [ns per call] and their
// ratio. `visp_control_law`: ViSP's usual call, which also projects a secondary task; `visp_steps`: only L_s,
// the error and its pseudo-inverse by ViSP. std::runtime_error: the twists of both sides differ.
std::vector<Figure> VispSpeed();

}  // namespace fovea::bench
