// SPDX-License-Identifier: Apache-2.0
// Pictures of a ball with known truth: rays cast through a grid of points in every pixel. Shares no code with
// the renderer or the detector.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>

namespace fovea::test {

struct BallPicture {
  int width_px = 640;
  int height_px = 480;
  double f_px = 554.256;
  double c_u_px = 319.5;
  double c_v_px = 239.5;
  double x = 0.0;  // centre in camera axes [m]
  double y = 0.0;
  double z = 0.4;
  double radius = 0.04;
  std::array<double, 3> ball_bgr{15.0, 18.0, 190.0};
  std::array<double, 3> ground_bgr{60.0, 52.0, 30.0};
  double shade = 0.0;  // how much darker the side away from the light is, 0 to 1
  double noise = 0.0;  // standard deviation [gray levels]
  unsigned seed = 1;
  int grid = 8;  // points per pixel, each way
};

inline cv::Mat RayCast(const BallPicture& p) {
  std::mt19937 engine(p.seed);
  std::normal_distribution<double> normal(0.0, std::max(p.noise, 1e-9));
  cv::Mat image(p.height_px, p.width_px, CV_8UC3);
  const double c2 = p.x * p.x + p.y * p.y + p.z * p.z;
  for (int v = 0; v < p.height_px; ++v) {
    for (int u = 0; u < p.width_px; ++u) {
      std::array<double, 3> sum{};
      for (int j = 0; j < p.grid; ++j) {
        for (int i = 0; i < p.grid; ++i) {
          const double dx = (u + (i + 0.5) / p.grid - 0.5 - p.c_u_px) / p.f_px;
          const double dy = (v + (j + 0.5) / p.grid - 0.5 - p.c_v_px) / p.f_px;
          const double d2 = dx * dx + dy * dy + 1.0;
          const double dc = dx * p.x + dy * p.y + p.z;
          const double disc = dc * dc - d2 * (c2 - p.radius * p.radius);
          for (std::size_t c = 0; c < 3; ++c) {
            if (disc < 0.0) {
              sum[c] += p.ground_bgr[c];
              continue;
            }
            const double t = (dc - std::sqrt(disc)) / d2;
            // Light from the upper left, behind the camera.
            const double nx = (t * dx - p.x) / p.radius;
            const double ny = (t * dy - p.y) / p.radius;
            const double nz = (t - p.z) / p.radius;
            const double lit = std::max(0.0, (-0.4 * nx - 0.5 * ny - 0.77 * nz));
            sum[c] += p.ball_bgr[c] * (1.0 - p.shade + p.shade * lit);
          }
        }
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = sum[c] / (p.grid * p.grid) + (p.noise > 0.0 ? normal(engine) : 0.0);
        image.at<cv::Vec3b>(v, u)[static_cast<int>(c)] =
            static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
      }
    }
  }
  return image;
}

}  // namespace fovea::test
