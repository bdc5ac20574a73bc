// SPDX-License-Identifier: Apache-2.0
// Draws pictures with known truth by ray casting, for the benchmark and for tests. A pixel that an edge
// crosses is the mean over a grid of rays. Shares no code with the simulator's renderer or with the detector.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace fovea::bench {

struct PictureCamera {
  int width_px = 640;
  int height_px = 480;
  double f_px = 554.256;
  double c_u_px = 319.5;
  double c_v_px = 239.5;
  // Brown's lens distortion as in OpenCV: k1, k2, p1, p2.
  Eigen::Vector4d lens = Eigen::Vector4d::Zero();
};

enum class Shape { kSphere, kDisc, kPolygon };

// An object in front of the camera, in camera axes (x right, y down, z forward) [m].
struct Body {
  Shape shape = Shape::kSphere;
  Eigen::Vector3d p{0.0, 0.0, 0.4};                 // centre
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();  // of a flat body: x right, y down, z into it
  double radius = 0.04;                             // of sphere and disc
  std::vector<Eigen::Vector2d> corners;             // of a convex polygon, in its plane, in order from x to y
  Eigen::Vector3d bgr{200.0, 200.0, 200.0};
  double shade = 0.0;  // how much darker a sphere is on the side away from the light, 0 to 1
  std::vector<Eigen::Vector3d> pattern;  // dark squares on a flat body: x, y, half side
};

struct PictureScene {
  PictureCamera camera;
  std::vector<Body> bodies;  // the first is the target, if there is one
  bool has_target = true;
  Eigen::Vector3d ground_bgr{60.0, 60.0, 60.0};
  double ground_swing = 0.0;  // amplitude of the ground's slow changes [gray levels]
  double blur_px = 0.0;       // standard deviation of the lens' Gaussian blur
  double noise = 0.0;         // standard deviation [gray levels]
  bool gray = true;           // one channel, the mean of the three
  unsigned seed = 1;
  int grid = 12;  // rays along each axis of a pixel that an edge crosses
};

// CV_8UC1 or CV_8UC3.
cv::Mat Draw(const PictureScene& scene);

// The index of the body that the ray through an image point meets, or -1 for the ground. `bgr`: its colour.
int Cast(const PictureScene& scene, double u_px, double v_px, Eigen::Vector3d& bgr);

// The outline of a body in the image of a lens without distortion.
struct TrueOutline {
  double u_px = 0.0;  // its centre
  double v_px = 0.0;
  double radius_px = 0.0;               // of the circle with the same area
  std::vector<Eigen::Vector2d> points;  // close together along it
};
TrueOutline OutlineOf(const PictureCamera& camera, const Body& body);

}  // namespace fovea::bench
