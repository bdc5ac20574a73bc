// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/vision/picture.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace fovea::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The ray of a pixel: the pinhole ray that the lens distorts to this pixel.
Vector3d RayOf(const PictureCamera& c, double u_px, double v_px) {
  const double xd = (u_px - c.c_u_px) / c.f_px;
  const double yd = (v_px - c.c_v_px) / c.f_px;
  double x = xd;
  double y = yd;
  if (!c.lens.isZero()) {
    for (int i = 0; i < 20; ++i) {
      const double r2 = x * x + y * y;
      const double k = 1.0 + c.lens[0] * r2 + c.lens[1] * r2 * r2;
      x = (xd - 2.0 * c.lens[2] * x * y - c.lens[3] * (r2 + 2.0 * x * x)) / k;
      y = (yd - c.lens[2] * (r2 + 2.0 * y * y) - 2.0 * c.lens[3] * x * y) / k;
    }
  }
  return {x, y, 1.0};
}

bool IsOnFlat(const Body& body, const Vector2d& q) {
  if (body.shape == Shape::kDisc) {
    return q.squaredNorm() <= body.radius * body.radius;
  }
  for (std::size_t i = 0; i < body.corners.size(); ++i) {
    const Vector2d& a = body.corners[i];
    const Vector2d side = body.corners[(i + 1) % body.corners.size()] - a;
    if (side.x() * (q.y() - a.y()) - side.y() * (q.x() - a.x()) < 0.0) {
      return false;
    }
  }
  return true;
}

// The depth z at which the ray (x, y, 1) meets the body, or infinity; and the colour there.
double Meet(const Body& body, const Vector3d& ray, Vector3d& bgr) {
  constexpr double kNever = 1e9;
  if (body.shape == Shape::kSphere) {
    const double a = ray.squaredNorm();
    const double b = ray.dot(body.p);
    const double under = b * b - a * (body.p.squaredNorm() - body.radius * body.radius);
    if (under < 0.0) {
      return kNever;
    }
    const double z = (b - std::sqrt(under)) / a;
    const Vector3d normal = (z * ray - body.p) / body.radius;
    // Light from the upper left, behind the camera.
    const double lit = std::max(0.0, normal.dot(Vector3d(-0.4, -0.5, -0.768)));
    bgr = body.bgr * (1.0 - body.shade + body.shade * lit);
    return z;
  }
  const Vector3d normal = body.R.col(2);
  const double along = normal.dot(ray);
  const double z = along != 0.0 ? normal.dot(body.p) / along : kNever;
  if (!(z > 0.0)) {
    return kNever;
  }
  const Vector3d q = body.R.transpose() * (z * ray - body.p);
  if (!IsOnFlat(body, q.head<2>())) {
    return kNever;
  }
  bgr = body.bgr;
  for (const Vector3d& dark : body.pattern) {
    if (std::fabs(q.x() - dark.x()) <= dark.z() && std::fabs(q.y() - dark.y()) <= dark.z()) {
      bgr.setConstant(20.0);
    }
  }
  return z;
}

// -1: ground. Other bodies have two labels each, so the edges of their dark patterns count as edges too.
int Label(int body, const Vector3d& bgr) { return body < 0 ? -1 : 2 * body + (bgr.sum() < 90.0 ? 1 : 0); }

void Blur(std::vector<Vector3d>& image, int width, int height, double sigma) {
  const int reach = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<double> kernel;
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
    sum += kernel.back();
  }
  const auto pass = [&](int du, int dv) {
    std::vector<Vector3d> out(image.size());
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        Vector3d value = Vector3d::Zero();
        for (int i = -reach; i <= reach; ++i) {
          const int x = std::clamp(u + i * du, 0, width - 1);
          const int y = std::clamp(v + i * dv, 0, height - 1);
          value += kernel[static_cast<std::size_t>(i + reach)] / sum *
                   image[static_cast<std::size_t>(y * width + x)];
        }
        out[static_cast<std::size_t>(v * width + u)] = value;
      }
    }
    image.swap(out);
  };
  pass(1, 0);
  pass(0, 1);
}

}  // namespace

int Cast(const PictureScene& scene, double u_px, double v_px, Vector3d& bgr) {
  const Vector3d ray = RayOf(scene.camera, u_px, v_px);
  double nearest = 1e8;
  int which = -1;
  const double phase = 0.7 * (scene.seed % 97);
  const double swing =
      scene.ground_swing * std::sin(3.1 * ray.x() + phase) * std::cos(2.3 * ray.y() - 0.6 * phase);
  bgr = (scene.ground_bgr.array() + swing).matrix();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    Vector3d colour = Vector3d::Zero();
    const double z = Meet(scene.bodies[i], ray, colour);
    if (z < nearest) {
      nearest = z;
      which = static_cast<int>(i);
      bgr = colour;
    }
  }
  return which;
}

cv::Mat Draw(const PictureScene& scene) {
  const int width = scene.camera.width_px;
  const int height = scene.camera.height_px;
  // An edge crosses a pixel when the labels of its corners and its centre differ.
  std::vector<int> label(static_cast<std::size_t>((width + 1) * (height + 1)));
  Vector3d bgr;
  for (int v = 0; v <= height; ++v) {
    for (int u = 0; u <= width; ++u) {
      const int body = Cast(scene, u - 0.5, v - 0.5, bgr);
      label[static_cast<std::size_t>(v * (width + 1) + u)] = Label(body, bgr);
    }
  }
  std::vector<Vector3d> image(static_cast<std::size_t>(width * height));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      Vector3d& pixel = image[static_cast<std::size_t>(v * width + u)];
      const auto corner = static_cast<std::size_t>(v * (width + 1) + u);
      const auto below = corner + static_cast<std::size_t>(width + 1);
      const int here = Label(Cast(scene, u, v, pixel), pixel);
      if (here == label[corner] && here == label[corner + 1] && here == label[below] &&
          here == label[below + 1]) {
        continue;
      }
      pixel.setZero();
      for (int j = 0; j < scene.grid; ++j) {
        for (int i = 0; i < scene.grid; ++i) {
          Cast(scene, u + (i + 0.5) / scene.grid - 0.5, v + (j + 0.5) / scene.grid - 0.5, bgr);
          pixel += bgr;
        }
      }
      pixel /= scene.grid * scene.grid;
    }
  }
  if (scene.blur_px > 0.0) {
    Blur(image, width, height, scene.blur_px);
  }
  std::mt19937 engine(scene.seed);
  std::normal_distribution<double> normal(0.0, std::max(scene.noise, 1e-9));
  cv::Mat out(height, width, scene.gray ? CV_8UC1 : CV_8UC3);
  const int channels = scene.gray ? 1 : 3;
  for (int v = 0; v < height; ++v) {
    auto* row = out.ptr<std::uint8_t>(v);
    for (int u = 0; u < width; ++u) {
      const Vector3d& pixel = image[static_cast<std::size_t>(v * width + u)];
      for (int c = 0; c < channels; ++c) {
        const double value =
            (scene.gray ? pixel.mean() : pixel[c]) + (scene.noise > 0.0 ? normal(engine) : 0.0);
        row[channels * u + c] = static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
      }
    }
  }
  return out;
}

TrueOutline OutlineOf(const PictureCamera& camera, const Body& body) {
  constexpr int kPoints = 4096;
  const auto project = [&](const Vector3d& p) -> Vector2d {
    return {camera.f_px * p.x() / p.z() + camera.c_u_px, camera.f_px * p.y() / p.z() + camera.c_v_px};
  };
  TrueOutline outline;
  if (body.shape == Shape::kPolygon) {
    const auto n = body.corners.size();
    const int per_side = kPoints / static_cast<int>(n);
    for (std::size_t k = 0; k < n; ++k) {
      for (int i = 0; i < per_side; ++i) {
        const double t = static_cast<double>(i) / per_side;
        const Vector2d q = (1.0 - t) * body.corners[k] + t * body.corners[(k + 1) % n];
        outline.points.push_back(project(body.R * Vector3d(q.x(), q.y(), 0.0) + body.p));
      }
      const Vector2d corner =
          project(body.R * Vector3d(body.corners[k].x(), body.corners[k].y(), 0.0) + body.p);
      outline.u_px += corner.x() / static_cast<double>(n);
      outline.v_px += corner.y() / static_cast<double>(n);
    }
  } else {
    // The circle where the rays touch the sphere, or the disc's rim.
    Vector3d middle = body.p;
    double radius = body.radius;
    Eigen::Matrix3d R = body.R;
    if (body.shape == Shape::kSphere) {
      const double sine2 = body.radius * body.radius / body.p.squaredNorm();
      middle = (1.0 - sine2) * body.p;
      radius = body.radius * std::sqrt(1.0 - sine2);
      R = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), body.p).toRotationMatrix();
    }
    for (int i = 0; i < kPoints; ++i) {
      const double a = 2.0 * std::numbers::pi * i / kPoints;
      outline.points.push_back(
          project(R * Vector3d(radius * std::cos(a), radius * std::sin(a), 0.0) + middle));
    }
  }
  double twice = 0.0;
  double su = 0.0;
  double sv = 0.0;
  const Vector2d origin = outline.points.front();
  for (std::size_t i = 0; i < outline.points.size(); ++i) {
    const Vector2d a = outline.points[i] - origin;
    const Vector2d b = outline.points[(i + 1) % outline.points.size()] - origin;
    const double cross = a.x() * b.y() - a.y() * b.x();
    twice += cross;
    su += cross * (a.x() + b.x()) / 3.0;
    sv += cross * (a.y() + b.y()) / 3.0;
  }
  if (body.shape != Shape::kPolygon) {
    outline.u_px = origin.x() + su / twice;
    outline.v_px = origin.y() + sv / twice;
  }
  outline.radius_px = std::sqrt(0.5 * std::fabs(twice) / std::numbers::pi);
  return outline;
}

}  // namespace fovea::bench
