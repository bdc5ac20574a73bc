// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/features/triangle.hpp"

#include <cmath>
#include <utility>

namespace fovea::features {

Polygon MakeTriangle(const std::array<double, 6>& corners) noexcept {
  Polygon triangle;
  triangle.num_corners = 3;
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.corners[i] = {corners[2 * i], corners[2 * i + 1], 0.0};
  }
  triangle.Centre();
  const auto& c = triangle.corners;
  if (model::Cross(c[1] - c[0], c[2] - c[0]).z() < 0.0) {
    std::swap(triangle.corners[1], triangle.corners[2]);
  }
  return triangle;
}

double FromSingularCylinder(const Polygon& triangle, const model::Pose& X_CO) noexcept {
  // The circumcentre m of a, b, c: |m - a| = |m - b| = |m - c|, two linear equations.
  const model::Vec3& a = triangle.corners[0];
  const model::Vec3 ab = triangle.corners[1] - a;
  const model::Vec3 ac = triangle.corners[2] - a;
  const double twice_area = ab.x() * ac.y() - ab.y() * ac.x();
  const double ab2 = ab.squaredNorm();
  const double ac2 = ac.squaredNorm();
  const double mx = (ac.y() * ab2 - ab.y() * ac2) / (2.0 * twice_area);
  const double my = (ab.x() * ac2 - ac.x() * ab2) / (2.0 * twice_area);
  const model::Vec3 p_OC = X_CO.Inverse().p;
  const double off_x = p_OC.x() - a.x() - mx;
  const double off_y = p_OC.y() - a.y() - my;
  return std::sqrt(off_x * off_x + off_y * off_y) - std::sqrt(mx * mx + my * my);
}

}  // namespace fovea::features
