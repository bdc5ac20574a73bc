#include "bound.hpp"

#include <Eigen/LU>
#include <cmath>
#include <vector>

namespace fovea::bench {

using Eigen::Vector2d;
using Eigen::Vector3d;

Bound CramerRao(const PictureScene& scene) {
  const TrueOutline outline = OutlineOf(scene.camera, scene.bodies.front());
  const int reach = static_cast<int>(std::ceil(3.0 * scene.blur_px)) + 2;
  const int width = scene.camera.width_px;
  const int height = scene.camera.height_px;
  // d(brightness) / d(u, v, r, and the two ways of a disc's outline to be longer than wide) of each pixel; of
  // a gray picture the mean channel's, else of each. A ball's outline has the shape of its place.
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  const int unknowns = scene.bodies.front().shape == Shape::kDisc ? 5 : 3;
  const int channels = scene.gray ? 1 : 3;
  std::vector<std::array<Vector5d, 3>> change(static_cast<std::size_t>(width * height),
                                              {Vector5d::Zero(), Vector5d::Zero(), Vector5d::Zero()});
  // The outline's own kernel: a point of it spreads over the pixels by the lens' blur.
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
    const Vector2d out_of = (at - middle) / outline.radius_px;
    Vector5d sweep;
    sweep << normal.x(), normal.y(), normal.dot(out_of), normal.x() * out_of.x() - normal.y() * out_of.y(),
        normal.x() * out_of.y() + normal.y() * out_of.x();
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
  // Rounding to whole levels is noise too.
  const double variance = scene.noise * scene.noise + 1.0 / 12.0;
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  for (const auto& pixel : change) {
    for (int c = 0; c < channels; ++c) {
      const Vector5d& g = pixel[static_cast<std::size_t>(c)];
      information += g * g.transpose() / variance;
    }
  }
  const Eigen::MatrixXd cov = Eigen::MatrixXd(information.topLeftCorner(unknowns, unknowns)).inverse();
  return {std::sqrt(0.5 * (cov(0, 0) + cov(1, 1))), std::sqrt(cov(2, 2))};
}

}  // namespace fovea::bench
