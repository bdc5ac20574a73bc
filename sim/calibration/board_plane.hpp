// A calibration board as the renderer has it: a textured plane that lies on the bench, a hand's breadth of
// paper about it.
#pragma once

#include <Eigen/Core>
#include <array>

#include "firmware/host/calibration/board.hpp"
#include "sim/render/bench.hpp"

namespace fovea::sim {

struct BoardPlane {
  TexturedPlane plane;
  Eigen::Vector3d middle_B = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 4> outline_B;  // of its squares
};

// Columns along x of B, rows against y: as one reads it from above. `middle_B` is on the table's top.
// InputError when its squares would be too fine to draw, or it would hang over.
BoardPlane MakeBoardPlane(const calibration::Board& board, const Eigen::Vector3d& middle_B);

}  // namespace fovea::sim
