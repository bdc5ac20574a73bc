// SPDX-License-Identifier: Apache-2.0
// The poses of three points from the rays to them (P3P). Fixed size, no heap.
//
// J. A. Grunert, Das Pothenotische Problem in erweiterter Gestalt (1841), as in R. M. Haralick et al., Review
// and analysis of solutions of the three point perspective pose estimation problem (1994): the ratio of two
// of the distances is a root of a polynomial of the fourth degree. The other ratio is then a quotient. If the
// quotient is ill-conditioned, the laws of cosines are solved directly.
#pragma once

#include <array>

#include "firmware/core/model/types.hpp"

namespace fovea::vision {

struct ThreePointPoses {
  int count = 0;
  std::array<model::Pose, 4> X_CO;
};

// `points_O` [m], not collinear; `rays_C` of length 1. If two poses coincide, or noise makes them complex,
// returns a pose near them, from which a refinement can start.
ThreePointPoses PosesOfThreePoints(const std::array<model::Vec3, 3>& points_O,
                                   const std::array<model::Vec3, 3>& rays_C);

}  // namespace fovea::vision
