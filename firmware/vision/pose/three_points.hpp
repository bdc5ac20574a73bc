// The poses from which three points look as they do. Of fixed size, without the heap.
//
// J. A. Grunert, Das Pothenotische Problem in erweiterter Gestalt (1841), as R. M. Haralick et al. have it,
// Review and analysis of solutions of the three point perspective pose estimation problem (1994): the ratio
// of two of the distances is a root of a polynomial of the fourth degree. The other ratio is a quotient then;
// where it has no figures left, the laws of cosines themselves are solved.
#pragma once

#include <array>

#include "firmware/core/model/types.hpp"

namespace fovea::vision {

struct ThreePointPoses {
  int count = 0;
  std::array<model::Pose, 4> X_CO;
};

// `points_O` [m], not on a line; `rays_C` of length 1. Where two poses have become one, or the least noise
// has made them none, a pose near to where they would be: a start for a search.
ThreePointPoses PosesOfThreePoints(const std::array<model::Vec3, 3>& points_O,
                                   const std::array<model::Vec3, 3>& rays_C);

}  // namespace fovea::vision
