// SPDX-License-Identifier: Apache-2.0
// Fits how a ball's brightness falls off towards its outline, from the samples of all lines (profiles.hpp),
// by a model of surface and light.
#include "firmware/vision/fit/shading.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "firmware/vision/fit/profiles.hpp"

namespace fovea::vision {

double SurfaceTurn(double d_px, double radius_px) {
  const double x = std::clamp(d_px / radius_px, 0.0, 1.0);
  return std::sqrt(x * (2.0 - x));
}

// Integrates the root's first terms: Simpson's rule would be inaccurate where the root is steep.
double MeanSurfaceTurn(double d_px, double radius_px) {
  const double high = d_px + 0.5;
  if (high <= 0.0) {
    return 0.0;
  }
  const double low = std::max(d_px - 0.5, 0.0);
  if (low > 2.0) {
    return SurfaceTurn(d_px, radius_px);
  }
  // Of sqrt(2 x / r) (1 - x / (4 r)).
  const auto integral = [radius_px](double x) {
    return std::sqrt(2.0 / radius_px) * x * std::sqrt(x) * (2.0 / 3.0 - x / (10.0 * radius_px));
  };
  return (integral(high) - integral(low)) / (high - low);
}

// The brightness of a matt surface under ambient light and one lamp is
//   A + S z + max(0, B (1 - d/r) + L z),  B = (b_u, b_v) . (n_u, n_v),
// at depth d inside an outline of radius r with normal (n_u, n_v); z is SurfaceTurn. So it falls off towards
// the outline on the lamp's side. The other side is in its own shadow, where it does not. A, S, b and L come
// from least squares; a few iterations find what is in the shadow. A line's shade is the slope of this
// brightness in z next to the outline.
void Profiles::FitShading(const std::array<double, kMaxLines>& at_px,
                          const std::array<double, kMaxLines>& weight, double radius_px, double blur_px) {
  using Vector5 = Eigen::Matrix<double, 5, 1>;  // A, S, b_u, b_v, L
  using Matrix5 = Eigen::Matrix<double, 5, 5>;
  constexpr int kTurns = 3;
  constexpr int kMostShaded = 64;  // about so many lines are enough
  const double clear = 2.5 * blur_px;
  const int every = std::max(1, count_ / kMostShaded);
  Vector5 light = Vector5::Zero();
  for (int turn = 0; turn < kTurns; ++turn) {
    Matrix5 normal = Matrix5::Zero();
    Vector5 right = Vector5::Zero();
    double n = 0.0;
    for (int i = 0; i < count_; i += every) {
      const auto k = static_cast<std::size_t>(i);
      if (!readable_[k] || weight[k] < 0.2) {
        continue;
      }
      const double side = light[2] * lines_[k].nu + light[3] * lines_[k].nv;
      for (int t = -kHalf; at_px[k] - t > clear; ++t) {
        const double d = at_px[k] - t;
        const double z = SurfaceTurn(d, radius_px);
        const double lean = std::max(1.0 - d / radius_px, 0.0);
        const auto j = static_cast<std::size_t>(t + kHalf);
        const auto y =
            static_cast<double>(gray_ ? value_[k][j + kPad]
                                      : surface_.dot(Eigen::Map<const Eigen::Vector3f>(&colour_[k][3 * j])));
        Vector5 row(1.0, z, 0.0, 0.0, 0.0);
        if (turn == 0 || side * lean + light[4] * z > 0.0) {
          row.tail<3>() << lines_[k].nu * lean, lines_[k].nv * lean, z;
        }
        for (Eigen::Index m = 0; m < row.size(); ++m) {
          for (Eigen::Index l = m; l < row.size(); ++l) {
            normal(l, m) += row[l] * row[m];  // its lower triangle is enough
          }
        }
        right += y * row;
        n += 1.0;
      }
    }
    // Keeps undetermined terms small, such as S against L when nothing is in the shadow.
    normal.diagonal().array() += 1e-4 * n + 1e-9;
    light = normal.ldlt().solve(right);
  }
  constexpr std::array kNextToIt{0.25, 1.0, 2.0, 3.0};  // [px inside the outline]
  constexpr double kEach = 1.0 / kNextToIt.size();
  std::array<double, kNextToIt.size()> z;
  double mean = 0.0;
  for (std::size_t j = 0; j < z.size(); ++j) {
    z[j] = MeanSurfaceTurn(kNextToIt[j], radius_px);
    mean += kEach * z[j];
  }
  double spread = 0.0;
  for (const double one : z) {
    spread += kEach * (one - mean) * (one - mean);
  }
  double seen2 = 0.0;
  for (int i = 0; i < count_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double side = light[2] * lines_[k].nu + light[3] * lines_[k].nv;
    double slope = light[1];
    for (std::size_t j = 0; j < z.size(); ++j) {
      const double lamp = std::max(0.0, side * (1.0 - kNextToIt[j] / radius_px) + light[4] * z[j]);
      slope += kEach * lamp * (z[j] - mean) / spread;
    }
    shade_[k] = (gray_ ? 1.0 : along_[k]) * slope;
    seen2 += slope * slope * spread / kEach;
  }
  // Used only if it is significant against the noise.
  constexpr double kSure = 4.0;
  shaded_ = light.allFinite() && seen2 > kSure * 5.0 * std::max(noise_ * noise_, 0.1);
  radius_px_ = radius_px;
}

}  // namespace fovea::vision
