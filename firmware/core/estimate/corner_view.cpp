// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/corner_view.hpp"

#include <array>

#include "firmware/core/model/cholesky.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {

using features::Polygon;
using features::SeenCorners;
using model::Mat3;
using model::Vec3;

namespace {

constexpr double kLeastVariance = 1e-16;  // of a pose, so that rounding leaves it positive [m^2, rad^2]

// The corners p + turn * arm, in axes of the camera, in its normalised image. False if one is not in front.
template <int kCorners>
bool SeeCorners(const Vec3& p, const Mat3& turn, const std::array<Vec3, Polygon::kMost>& arms,
                Eigen::Matrix<double, 2 * kCorners, 1>& xy) noexcept {
  for (int i = 0; i < kCorners; ++i) {
    const Vec3 p_C = p + turn.lazyProduct(arms[static_cast<std::size_t>(i)]);
    if (!(p_C.z() >= features::kMinDepth)) {
      return false;
    }
    xy[2 * i] = p_C.x() / p_C.z();
    xy[2 * i + 1] = p_C.y() / p_C.z();
  }
  return true;
}

// ExpectAround for so many corners: sizes that the compiler knows save work.
template <int kCorners>
bool ExpectWith(const Polygon& polygon, const model::Pose& X_CB, const model::Pose& X_BO,
                const model::Mat6& P, SeenCorners::Vector& mean, CornerSlope& H,
                SeenCorners::Covariance& bent) noexcept {
  constexpr double kFar = 2.449489742783178;  // sqrt(6)
  constexpr int kSize = 2 * kCorners;
  model::Mat6 L = P;
  L.diagonal().array() += kLeastVariance;
  model::FactorCholesky(L);
  L.triangularView<Eigen::StrictlyUpper>().setZero();
  // In axes of the camera: O, and the corners from there.
  const Vec3 p_CO = X_CB * X_BO.p;
  std::array<Vec3, Polygon::kMost> arms;
  for (std::size_t k = 0; k < static_cast<std::size_t>(kCorners); ++k) {
    arms[k] = X_CB.R.lazyProduct(X_BO.R.lazyProduct(polygon.corners[k]));
  }
  std::array<Eigen::Matrix<double, kSize, 1>, 12> at;
  for (std::size_t i = 0; i < 6; ++i) {
    const model::Vec6 off = kFar * L.col(static_cast<Eigen::Index>(i));
    const Vec3 shift = X_CB.R.lazyProduct(off.head<3>());
    const Mat3 turn = model::RotationOf(X_CB.R.lazyProduct(off.tail<3>()));
    if (!SeeCorners<kCorners>(p_CO + shift, turn, arms, at[i]) ||
        !SeeCorners<kCorners>(p_CO - shift, turn.transpose(), arms, at[i + 6])) {
      return false;
    }
  }
  Eigen::Matrix<double, kSize, 1> centre = Eigen::Matrix<double, kSize, 1>::Zero();
  for (const auto& corners : at) {
    centre += corners / 12.0;
  }
  Eigen::Matrix<double, 6, kSize> turned;
  Eigen::Matrix<double, kSize, kSize> bows = Eigen::Matrix<double, kSize, kSize>::Zero();
  for (std::size_t i = 0; i < 6; ++i) {
    const Eigen::Matrix<double, kSize, 1> bow = 0.5 * (at[i] + at[i + 6]) - centre;
    turned.row(static_cast<Eigen::Index>(i)) = ((at[i] - at[i + 6]) / (2.0 * kFar)).transpose();
    for (Eigen::Index c = 0; c < kSize; ++c) {
      for (Eigen::Index r = c; r < kSize; ++r) {
        bows(r, c) += bow[r] * bow[c] / 6.0;
      }
    }
  }
  model::SolveLowerTransposed(L, turned);
  mean = centre;
  H = turned.transpose();
  bent = bows;
  return true;
}

}  // namespace

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

bool ExpectAround(const Polygon& polygon, const model::Pose& X_CB, const model::Pose& X_BO,
                  const model::Mat6& P, SeenCorners::Vector& mean, CornerSlope& H,
                  SeenCorners::Covariance& bent) noexcept {
  return polygon.num_corners == 4 ? ExpectWith<4>(polygon, X_CB, X_BO, P, mean, H, bent)
                                  : ExpectWith<3>(polygon, X_CB, X_BO, P, mean, H, bent);
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
