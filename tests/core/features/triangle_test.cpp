// SPDX-License-Identifier: Apache-2.0
// What three corners can control: L_s loses rank on the cylinder through them, not where the notes of the
// course exercises say.
#include "firmware/core/features/triangle.hpp"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <iostream>

#include "firmware/core/model/math.hpp"
#include "tests/core/features/camera_steps.hpp"

namespace fovea::features {
namespace {

using model::Vec3;

// The triangle seen by a camera at `p_OC` that looks at its centre.
TargetInCamera From(const Vec3& p_OC) {
  const Vec3 z = -p_OC.normalized();
  const Vec3 x = Vec3(0, 1, 0).cross(z).normalized();
  model::Pose X_OC;
  X_OC.R << x, z.cross(x), z;
  X_OC.p = p_OC;
  return {X_OC.Inverse(), Vec3::Zero(), Vec3::Zero()};
}

double InverseCondition(const Polygon& triangle, const Vec3& p_OC) {
  FeatureState state;
  const TargetInCamera seen = From(p_OC);
  EXPECT_TRUE(ComputeCorners(triangle, seen, {model::Mat3::Identity(), {0, 0, 0.4}}, state));
  const Eigen::MatrixXd L_s = state.L_s;
  const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(L_s).singularValues();
  return sigma[5] / sigma[0];
}

Polygon Equilateral() {
  const double r = 0.06;
  const double c = r * std::sqrt(0.75);
  return MakeTriangle({0.0, -r, c, 0.5 * r, -c, 0.5 * r});
}

TEST(TriangleTest, LosesRankOnTheCylinderThroughItsCorners) {
  for (const Polygon& triangle : {MakeTriangle(kDefaultTriangle), Equilateral()}) {
    // The cylinder's axis and radius from the circumcentre's barycentric weights: not triangle.cpp's formula.
    const Vec3 a = triangle.corners[0], b = triangle.corners[1], c = triangle.corners[2];
    const double A = (b - c).norm(), B = (c - a).norm(), C = (a - b).norm();
    const double wa = A * A * (B * B + C * C - A * A), wb = B * B * (C * C + A * A - B * B),
                 wc = C * C * (A * A + B * B - C * C);
    const Vec3 axis = (wa * a + wb * b + wc * c) / (wa + wb + wc);
    const double radius = (a - axis).norm();
    double worst_on = 0.0;
    double worst_off = 1.0;
    for (int k = 0; k < 24; ++k) {
      const double angle = 0.1 + 2.0 * model::kPi * k / 24;
      const Vec3 out(std::cos(angle), std::sin(angle), 0.0);
      const Vec3 on = axis + radius * out + Vec3(0, 0, -0.4);
      EXPECT_NEAR(FromSingularCylinder(triangle, From(on).X_CO), 0.0, 1e-12);
      worst_on = std::max(worst_on, InverseCondition(triangle, on));
      for (const double off : {-0.02, 0.02}) {
        const Vec3 beside = on + off * out;
        EXPECT_NEAR(FromSingularCylinder(triangle, From(beside).X_CO), off, 1e-12);
        worst_off = std::min(worst_off, InverseCondition(triangle, beside));
      }
    }
    std::cout << "1 / condition: on the cylinder at most " << worst_on << ", 20 mm off it at least "
              << worst_off << "\n";
    EXPECT_LT(worst_on, 1e-12);
    EXPECT_GT(worst_off, 1e-4);
  }
}

// Corrects a claim of the course exercises: an equilateral triangle controls the turn about its normal like
// any other.
TEST(TriangleTest, EquilateralTriangleIsWellConditioned) {
  const double from_above = InverseCondition(Equilateral(), {0.0, 0.0, -0.4});
  const double aside = InverseCondition(Equilateral(), {0.15, 0.1, -0.4});
  std::cout << "equilateral, 1 / condition: from above " << from_above << ", from the side " << aside << "\n";
  EXPECT_GT(from_above, 1e-3);
  EXPECT_GT(aside, 1e-3);
}

TEST(TriangleTest, DefaultTriangleIsCentredWithThreeDifferentSides) {
  const Polygon t = MakeTriangle(kDefaultTriangle);
  EXPECT_LT((t.corners[0] + t.corners[1] + t.corners[2]).norm(), 1e-15);
  const double a = (t.corners[1] - t.corners[2]).norm();
  const double b = (t.corners[2] - t.corners[0]).norm();
  const double c = (t.corners[0] - t.corners[1]).norm();
  std::cout << "sides " << a << ", " << b << ", " << c << " m\n";
  EXPECT_GT(std::min({std::abs(a - b), std::abs(b - c), std::abs(c - a)}), 0.015);
}

}  // namespace
}  // namespace fovea::features
