// SPDX-License-Identifier: Apache-2.0
#include "tests/visp/visp_laws.hpp"

#include <visp3/visual_features/vpFeatureDepth.h>
#include <visp3/visual_features/vpFeaturePoint.h>
#include <visp3/visual_features/vpFeatureThetaU.h>
#include <visp3/visual_features/vpFeatureTranslation.h>
#include <visp3/vs/vpServo.h>

#include <cmath>
#include <deque>

namespace fovea::test {
namespace {

vpHomogeneousMatrix Matrix(const std::array<double, 16>& X) {
  vpHomogeneousMatrix M;
  for (unsigned row = 0; row < 3; ++row) {
    for (unsigned col = 0; col < 4; ++col) {
      M[row][col] = X[4 * row + col];
    }
  }
  return M;
}

vpFeaturePoint PointAt(double X, double Y, double Z) {
  vpFeaturePoint point;
  point.buildFrom(X / Z, Y / Z, Z);
  return point;
}

vpServo::vpServoIteractionMatrixType MatrixOf(VispLaw law) {
  switch (law) {
    case VispLaw::kMean: return vpServo::MEAN;
    case VispLaw::kDesired: return vpServo::DESIRED;
    default: return vpServo::CURRENT;
  }
}

}  // namespace

std::array<double, 6> VispTwist(VispLaw law, const VispView& now, const VispView& goal, double lambda) {
  const vpHomogeneousMatrix cMo = Matrix(now.X_CO);
  const vpHomogeneousMatrix cdMo = Matrix(goal.X_CO);
  std::deque<vpFeaturePoint> points;  // a task keeps pointers
  vpFeatureTranslation t(vpFeatureTranslation::cMo);
  vpFeatureTranslation t_star(vpFeatureTranslation::cMo);
  vpFeatureThetaU turn(vpFeatureThetaU::cdRc);
  vpFeatureThetaU no_turn(vpFeatureThetaU::cdRc);
  vpFeatureDepth depth;
  vpFeatureDepth no_depth;
  vpServo servo;
  servo.setServo(vpServo::EYEINHAND_CAMERA);
  servo.setInteractionMatrixType(MatrixOf(law), vpServo::PSEUDO_INVERSE);
  servo.setLambda(lambda);
  const auto add_point = [&](const std::array<double, 3>& at, const std::array<double, 3>& at_goal) {
    vpFeaturePoint& s = points.emplace_back(PointAt(at[0], at[1], at[2]));
    vpFeaturePoint& s_star = points.emplace_back(PointAt(at_goal[0], at_goal[1], at_goal[2]));
    servo.addFeature(s, s_star);
  };
  const auto add_turn = [&] {
    turn.buildFrom(cdMo * cMo.inverse());
    servo.addFeature(turn, no_turn);
  };
  if (law == VispLaw::kPbvs) {
    t.buildFrom(cMo);
    t_star.buildFrom(cdMo);
    servo.addFeature(t, t_star);
    add_turn();
  } else if (law == VispLaw::kHybrid) {
    add_point({cMo[0][3], cMo[1][3], cMo[2][3]}, {cdMo[0][3], cdMo[1][3], cdMo[2][3]});
    const double Z = cMo[2][3];
    depth.buildFrom(cMo[0][3] / Z, cMo[1][3] / Z, Z, std::log(Z / cdMo[2][3]));
    no_depth.buildFrom(cdMo[0][3] / cdMo[2][3], cdMo[1][3] / cdMo[2][3], cdMo[2][3], 0.0);
    servo.addFeature(depth, no_depth);
    add_turn();
  } else {
    for (std::size_t k = 0; k < now.p_CP_C.size(); ++k) {
      add_point(now.p_CP_C[k], goal.p_CP_C[k]);
    }
  }
  const vpColVector V = servo.computeControlLaw();
  servo.kill();
  return {V[0], V[1], V[2], V[3], V[4], V[5]};
}

}  // namespace fovea::test
