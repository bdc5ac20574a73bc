// SPDX-License-Identifier: Apache-2.0
// A calibration board for the renderer: a textured plane on the bench with a paper margin around the squares.
#pragma once

#include <Eigen/Core>
#include <array>

#include "firmware/host/calibration/board.hpp"
#include "sim/render/bench.hpp"

namespace fovea::sim {

struct BoardPlane {
  TexturedPlane plane;
  Eigen::Vector3d middle_B = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 4> outline_B;  // corners of the area of its squares
};

// The board is readable from above: columns along +x of B, rows along -y. `middle_B` is on the table's top.
// InputError: the squares are too fine to draw, or the board does not fit on the bench.
BoardPlane MakeBoardPlane(const calibration::Board& board, const Eigen::Vector3d& middle_B);

}  // namespace fovea::sim
