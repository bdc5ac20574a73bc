// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/corner_view.hpp"

namespace fovea::estimate {

using features::Polygon;
using features::SeenCorners;
using model::Vec3;

bool ExpectCorners(const Polygon& polygon, const model::Pose& X_CB, const model::Pose& X_BO,
                   SeenCorners::Vector& xy) noexcept {
  xy.resize(2 * polygon.num_corners);
  for (int i = 0; i < polygon.num_corners; ++i) {
    const Vec3 p = X_CB * (X_BO * polygon.corners[static_cast<std::size_t>(i)]);
    if (!(p.z() >= features::kMinDepth)) {
      return false;
    }
    xy.segment<2>(2 * i) << p.x() / p.z(), p.y() / p.z();
  }
  return true;
}

void SlopeOfCorners(const Polygon& polygon, const model::Pose& X_CB, const model::Pose& X_BO,
                    CornerSlope& H) noexcept {
  H.resize(2 * polygon.num_corners, 6);
  for (int i = 0; i < polygon.num_corners; ++i) {
    const Vec3 arm = X_BO.R * polygon.corners[static_cast<std::size_t>(i)];
    const Vec3 p = X_CB * Vec3(X_BO.p + arm);
    Eigen::Matrix<double, 2, 3> project;
    project << 1.0, 0.0, -p.x() / p.z(), 0.0, 1.0, -p.y() / p.z();
    const Eigen::Matrix<double, 2, 3> by_position = project * X_CB.R / p.z();
    H.block<2, 3>(2 * i, 0) = by_position;
    H.block<2, 3>(2 * i, 3) = -by_position * model::CrossMatrix(arm);
  }
}

void InOrder(const SeenCorners& seen, int first, SeenCorners::Vector& xy,
             SeenCorners::Covariance& cov) noexcept {
  const auto n = static_cast<int>(seen.xy.size() / 2);
  xy.resize(2 * n);
  cov.resize(2 * n, 2 * n);
  for (int i = 0; i < n; ++i) {
    const int from = 2 * ((first + i) % n);
    xy.segment<2>(2 * i) = seen.xy.segment<2>(from);
    for (int j = 0; j < n; ++j) {
      cov.block<2, 2>(2 * i, 2 * j) = seen.cov.block<2, 2>(from, 2 * ((first + j) % n));
    }
  }
}

int NearestFirst(const SeenCorners::Vector& seen, const SeenCorners::Vector& expected) noexcept {
  const auto n = static_cast<int>(seen.size() / 2);
  int best = 0;
  double best_off = 0.0;
  for (int first = 0; first < n; ++first) {
    double off = 0.0;
    for (int i = 0; i < n; ++i) {
      off += (seen.segment<2>(2 * ((first + i) % n)) - expected.segment<2>(2 * i)).squaredNorm();
    }
    if (first == 0 || off < best_off) {
      best = first;
      best_off = off;
    }
  }
  return best;
}

}  // namespace fovea::estimate
