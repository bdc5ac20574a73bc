// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/vision/bound.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace fovea::bench {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr int kMost = 8;  // unknowns
using Change = Eigen::Matrix<double, kMost, 1>;

// Normal displacement of an outline point per unit of u, v, r and of the two elongations of a disc's outline.
// A ball's elongation follows from its position. `out_of`: the point relative to the centre, in radii.
Change SweepOfRound(const Vector2d& out_of, const Vector2d& normal) {
  Change sweep = Change::Zero();
  sweep.head<5>() << normal.x(), normal.y(), normal.dot(out_of),
      normal.x() * out_of.x() - normal.y() * out_of.y(), normal.x() * out_of.y() + normal.y() * out_of.x();
  return sweep;
}

// The same per unit of the corners' coordinates. Point `i` of `points` moves with the two corners of its
// side; all sides have the same number of points.
Change SweepOfCorners(std::size_t points, std::size_t corners, std::size_t i, const Vector2d& normal) {
  const std::size_t per_side = points / corners;
  const std::size_t side = i / per_side;
  const double t = (static_cast<double>(i % per_side) + 0.5) / static_cast<double>(per_side);
  Change sweep = Change::Zero();
  sweep.segment<2>(static_cast<Eigen::Index>(2 * side)) += (1.0 - t) * normal;
  sweep.segment<2>(static_cast<Eigen::Index>(2 * ((side + 1) % corners))) += t * normal;
  return sweep;
}

// Derivatives of the corners' mean, and of the radius of the circle with the polygon's area, with respect to
// the corners. [3 x 2 corners]
Eigen::MatrixXd MiddleAndRadius(const TrueOutline& outline, std::size_t corners) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3, static_cast<Eigen::Index>(2 * corners));
  const std::size_t per_side = outline.points.size() / corners;
  const auto at = [&](std::size_t k) { return outline.points[(k % corners) * per_side]; };
  double twice = 0.0;
  for (std::size_t k = 0; k < corners; ++k) {
    twice += at(k).x() * at(k + 1).y() - at(k).y() * at(k + 1).x();
  }
  // radius^2 = area / pi
  const double scale = (twice < 0.0 ? -0.25 : 0.25) / (std::numbers::pi * outline.radius_px);
  for (std::size_t k = 0; k < corners; ++k) {
    const auto column = static_cast<Eigen::Index>(2 * k);
    const Vector2d across = at(k + 1) - at(k + corners - 1);
    J(0, column) = J(1, column + 1) = 1.0 / static_cast<double>(corners);
    J(2, column) = scale * across.y();
    J(2, column + 1) = -scale * across.x();
  }
  return J;
}

}  // namespace

Bound CramerRao(const PictureScene& scene) {
  const TrueOutline outline = OutlineOf(scene.camera, scene.bodies.front());
  const int reach = static_cast<int>(std::ceil(3.0 * scene.blur_px)) + 2;
  const int width = scene.camera.width_px;
  const int height = scene.camera.height_px;
  // d(brightness) / d(unknowns) of each pixel and channel; a gray picture has one channel, the mean.
  const Body& body = scene.bodies.front();
  const bool polygon = body.shape == Shape::kPolygon;
  const std::size_t corners = body.corners.size();
  const int unknowns = polygon ? 2 * static_cast<int>(corners) : body.shape == Shape::kDisc ? 5 : 3;
  const int channels = scene.gray ? 1 : 3;
  std::vector<std::array<Change, 3>> change(static_cast<std::size_t>(width * height),
                                            {Change::Zero(), Change::Zero(), Change::Zero()});
  // The lens blur spreads each point of the outline over the pixels around it.
  const Vector2d middle(outline.u_px, outline.v_px);
  for (std::size_t i = 0; i < outline.points.size(); ++i) {
    const Vector2d a = outline.points[i];
    const Vector2d b = outline.points[(i + 1) % outline.points.size()];
    const Vector2d at = 0.5 * (a + b);
    const Vector2d side = b - a;
    Vector2d normal(side.y(), -side.x());
    normal /= std::max(normal.norm(), 1e-12);
    if (normal.dot(at - middle) < 0.0) {
      normal = -normal;
    }
    Vector3d inside;
    Vector3d outside;
    const Vector2d in = at - 0.3 * normal;
    const Vector2d out = at + 0.3 * normal;
    if (Cast(scene, in.x(), in.y(), inside) != 0) {
      continue;
    }
    Cast(scene, out.x(), out.y(), outside);
    const Vector3d step = inside - outside;
    const Change sweep = polygon ? SweepOfCorners(outline.points.size(), corners, i, normal)
                                 : SweepOfRound((at - middle) / outline.radius_px, normal);
    const auto add = [&](int u, int v, double share) {
      if (u < 0 || v < 0 || u >= width || v >= height) {
        return;
      }
      auto& pixel = change[static_cast<std::size_t>(v * width + u)];
      for (int c = 0; c < channels; ++c) {
        pixel[static_cast<std::size_t>(c)] +=
            share * side.norm() * (scene.gray ? step.mean() : step[c]) * sweep;
      }
    };
    const int u0 = static_cast<int>(std::lround(at.x()));
    const int v0 = static_cast<int>(std::lround(at.y()));
    if (!(scene.blur_px > 0.0)) {
      add(u0, v0, 1.0);
      continue;
    }
    const double scale = 1.0 / (std::sqrt(2.0) * scene.blur_px);
    for (int v = v0 - reach; v <= v0 + reach; ++v) {
      for (int u = u0 - reach; u <= u0 + reach; ++u) {
        const double du = u - at.x();
        const double dv = v - at.y();
        add(u, v,
            0.25 * (std::erf((du + 0.5) * scale) - std::erf((du - 0.5) * scale)) *
                (std::erf((dv + 0.5) * scale) - std::erf((dv - 0.5) * scale)));
      }
    }
  }
  // Rounding to whole gray levels adds noise.
  const double variance = scene.noise * scene.noise + 1.0 / 12.0;
  Eigen::Matrix<double, kMost, kMost> information = Eigen::Matrix<double, kMost, kMost>::Zero();
  for (const auto& pixel : change) {
    for (int c = 0; c < channels; ++c) {
      const Change& g = pixel[static_cast<std::size_t>(c)];
      information += g * g.transpose() / variance;
    }
  }
  const Eigen::FullPivLU<Eigen::MatrixXd> lu(Eigen::MatrixXd(information.topLeftCorner(unknowns, unknowns)));
  if (!lu.isInvertible()) {  // a side is hidden completely
    return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  const Eigen::MatrixXd cov = lu.inverse();
  if (!polygon) {
    return {std::sqrt(0.5 * (cov(0, 0) + cov(1, 1))), std::sqrt(cov(2, 2))};
  }
  const Eigen::MatrixXd J = MiddleAndRadius(outline, corners);
  const Eigen::Matrix3d of = J * cov * J.transpose();
  return {std::sqrt(0.5 * (of(0, 0) + of(1, 1))), std::sqrt(of(2, 2))};
}

}  // namespace fovea::bench
