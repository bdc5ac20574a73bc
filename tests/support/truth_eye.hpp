// SPDX-License-Identifier: Apache-2.0
// A camera that measures the truth: measurements of any target from its true pose, with noise given in pixels
// and the matching covariance. For closed loops without renderer and detector.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>

#include "firmware/core/features/target_feature.hpp"

namespace fovea::test {

class TruthEye {
 public:
  // `sigma_px`: noise of each corner, or of centre and radius. 0: no noise, but the covariance of 0.01 px.
  TruthEye(const features::TargetFeature& feature, double f_px, double sigma_px, unsigned seed)
      : feature_(feature), sigma_(std::max(sigma_px, 0.01) / f_px), noisy_(sigma_px > 0.0), engine_(seed) {}

  // The measurement of a target at `X_CO`.
  hal::FeatureMeasurement See(const model::Pose& X_CO, std::int64_t stamp_ns, std::uint64_t sequence) {
    hal::FeatureMeasurement m;
    m.stamp_ns = stamp_ns;
    m.sequence = sequence;
    m.kind = feature_.target;
    m.found = true;
    m.confidence = 1.0;
    if (feature_.SeesOrientation()) {
      SeeCorners(X_CO, m);
    } else {
      SeeCentre(X_CO.p, m);
    }
    return m;
  }

 private:
  // A draw of N(0, cov).
  template <int N>
  Eigen::Matrix<double, N, 1> Noise(const Eigen::Matrix<double, N, N>& cov) {
    Eigen::Matrix<double, N, 1> white;
    for (int i = 0; i < N; ++i) {
      white[i] = noisy_ ? normal_(engine_) : 0.0;
    }
    return cov.llt().matrixL() * white;
  }

  template <int N>
  static void SetCovariance(const Eigen::Matrix<double, N, N>& cov, hal::FeatureMeasurement& m) {
    for (int row = 0; row < N; ++row) {
      for (int col = 0; col < N; ++col) {
        m.cov_s[static_cast<std::size_t>(row * hal::kMaxFeatureDim + col)] = cov(row, col);
      }
    }
  }

  // Centre (x, y) and half size R/Z with noise `sigma_` each, converted to the position p_CO_C.
  void SeeCentre(const model::Vec3& p, hal::FeatureMeasurement& m) {
    const double z = p.z();
    model::Mat3 dp;  // d p_CO_C / d(x, y, R/Z)
    dp << z, 0.0, -p.x() * z / feature_.radius, 0.0, z, -p.y() * z / feature_.radius, 0.0, 0.0,
        -z * z / feature_.radius;
    const model::Mat3 cov_p = sigma_ * sigma_ * dp * dp.transpose();
    const model::Vec3 seen = p + Noise<3>(cov_p);
    model::Vec3 s;
    model::Mat3 ds;
    if (feature_.target == hal::FeatureKind::kSphere) {
      s = seen / feature_.radius;
      ds = model::Mat3::Identity() / feature_.radius;
    } else {
      s = model::Vec3(seen.x(), seen.y(), 2.0 * feature_.radius) / seen.z();
      ds << 1.0, 0.0, -s.x(), 0.0, 1.0, -s.y(), 0.0, 0.0, -s.z();
      ds /= seen.z();
    }
    m.dim = 3;
    for (int i = 0; i < 3; ++i) {
      m.s[static_cast<std::size_t>(i)] = s[i];
    }
    SetCovariance<3>(ds * cov_p * ds.transpose(), m);
  }

  // Corners with noise `sigma_` each, and the true pose.
  void SeeCorners(const model::Pose& X_CO, hal::FeatureMeasurement& m) {
    m.dim = 2 * feature_.corners.num_corners;
    for (int i = 0; i < feature_.corners.num_corners; ++i) {
      const model::Vec3 p = X_CO * feature_.corners.corners[static_cast<std::size_t>(i)];
      for (int k = 0; k < 2; ++k) {
        const int entry = 2 * i + k;
        const double off = noisy_ ? sigma_ * normal_(engine_) : 0.0;
        m.s[static_cast<std::size_t>(entry)] = p[k] / p.z() + off;
        m.cov_s[static_cast<std::size_t>(entry * (hal::kMaxFeatureDim + 1))] = sigma_ * sigma_;
      }
    }
    const Eigen::Quaterniond q(X_CO.R);
    m.num_poses = 1;
    m.poses[0] = {{X_CO.p.x(), X_CO.p.y(), X_CO.p.z()}, {q.w(), q.x(), q.y(), q.z()}, 0};
  }

  const features::TargetFeature feature_;
  const double sigma_;
  const bool noisy_;
  std::mt19937_64 engine_;
  std::normal_distribution<double> normal_;
};

}  // namespace fovea::test
