// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/vision/scenes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "firmware/host/config/target_keys.hpp"
#include "firmware/vision/pose/flat_corners.hpp"

namespace fovea::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRadiusMinPx = 12.0;
constexpr double kRadiusMaxPx = 150.0;
constexpr double kDiameter = 0.08;  // of ball and disc [m]
constexpr double kSide = 0.08;      // of the square [m]
constexpr std::array<double, 6> kTriangle{-0.05, 0.04, -0.02, -0.06, 0.06, 0.03};

class Chance {
 public:
  explicit Chance(unsigned seed) : engine_(seed) {}
  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  bool Coin() { return Between(0.0, 1.0) < 0.5; }

 private:
  std::mt19937 engine_;
};

Eigen::Matrix3d Turn(Chance& chance, double most_tilt) {
  const double about = chance.Between(0.0, 2.0 * std::numbers::pi);
  const double tilt = chance.Between(0.0, most_tilt);
  return (Eigen::AngleAxisd(tilt, Vector3d(std::cos(about), std::sin(about), 0.0)) *
          Eigen::AngleAxisd(chance.Between(-std::numbers::pi, std::numbers::pi), Vector3d::UnitZ()))
      .toRotationMatrix();
}

// The size of a plate: `radius` of the circle with its area [m], `reach` of its furthest corner in radii, and
// `clutter`, the size by which AddScaled divides [m].
struct PlateSize {
  double radius;
  double reach;
  double clutter;
};

PlateSize SizeOf(const features::TargetFeature& target) {
  // The published figures come from pictures that were drawn with these sizes.
  struct Drawn {
    TargetKind kind;
    PlateSize size;
  };
  static const Drawn kDrawn[] = {
      {TargetKind::kSquare, {kSide / std::sqrt(std::numbers::pi), 1.4, kSide / 1.6}},
      {TargetKind::kTriangle, {0.0416, 1.9, 0.0416}},
  };
  for (const Drawn& drawn : kDrawn) {
    if (drawn.kind == target.target) {
      return drawn.size;
    }
  }
  const std::vector<Vector2d> corners = vision::FlatCorners(target.corners);
  double twice_area = 0.0;
  double furthest = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d& a = corners[i];
    const Vector2d& b = corners[(i + 1) % corners.size()];
    twice_area += a.x() * b.y() - a.y() * b.x();
    furthest = std::max(furthest, a.norm());
  }
  const double radius = std::sqrt(0.5 * twice_area / std::numbers::pi);
  return {radius, 1.1 * furthest / radius, radius};
}

Body MakeTarget(TargetKind kind, const PictureCamera& camera, bool off_axis, Chance& chance) {
  const features::TargetFeature target = TargetOf(kind);
  Body body;
  double radius = target.radius;
  double reach = 1.0;  // of the furthest point of the outline, in radii
  switch (features::TraitsOf(kind).body) {
    case features::TargetBody::kBall:
      body.radius = radius;
      body.shade = off_axis ? 0.4 : 0.0;
      break;
    case features::TargetBody::kDisc:
      body.shape = Shape::kDisc;
      body.radius = radius;
      body.R = Turn(chance, 0.9);
      break;
    case features::TargetBody::kPlate: {
      const PlateSize size = SizeOf(target);
      body.shape = Shape::kPolygon;
      body.corners = vision::FlatCorners(target.corners);
      body.R = Turn(chance, 0.7);
      radius = size.radius;
      reach = size.reach;
      break;
    }
  }
  const bool flat = features::TraitsOf(kind).body == features::TargetBody::kPlate;
  const double least = flat ? 20.0 : kRadiusMinPx;
  const double most = off_axis ? 80.0 : flat ? 100.0 : kRadiusMaxPx;
  const double radius_px = least * std::pow(most / least, chance.Between(0.0, 1.0));
  body.p.z() = camera.f_px * radius / radius_px;
  // Leaves room for the longer outlines off the axis, and for the search lines across the outline.
  const double room = 1.25 * reach * radius_px + 14.0;
  const double u_most = std::max(0.0, 0.5 * camera.width_px - room);
  const double v_most = std::max(0.0, 0.5 * camera.height_px - room);
  double u = chance.Between(-u_most, u_most);
  double v = chance.Between(-v_most, v_most);
  if (off_axis) {
    u = (chance.Coin() ? 1.0 : -1.0) * chance.Between(0.7, 1.0) * u_most;
    v = (chance.Coin() ? 1.0 : -1.0) * chance.Between(0.7, 1.0) * v_most;
  }
  body.p.x() = body.p.z() * u / camera.f_px;
  body.p.y() = body.p.z() * v / camera.f_px;
  return body;
}

// A bar in front of the target that hides the share `hidden` of its outline.
Body MakeOccluder(const PictureCamera& camera, const Body& target, double hidden, Chance& chance) {
  const TrueOutline outline = OutlineOf(camera, target);
  const double about = chance.Between(0.0, 2.0 * std::numbers::pi);
  const Vector2d out(std::cos(about), std::sin(about));
  std::vector<double> along;
  for (const Vector2d& p : outline.points) {
    along.push_back(out.dot(p));
  }
  const auto at =
      along.begin() + static_cast<std::ptrdiff_t>((1.0 - hidden) * static_cast<double>(along.size()));
  std::nth_element(along.begin(), at, along.end());
  const double edge = *at;  // the share `hidden` of the outline's points is further out
  Body body;
  body.shape = Shape::kPolygon;
  body.p = Vector3d(0.0, 0.0, 0.4 * target.p.z());
  const double scale = body.p.z() / camera.f_px;
  const Vector2d centre(camera.c_u_px, camera.c_v_px);
  const Vector2d aside(-out.y(), out.x());
  const Vector2d start = edge * out + aside.dot(Vector2d(outline.u_px, outline.v_px)) * aside;
  const double wide = 2.0 * outline.radius_px + 20.0;
  const double deep = 1.5 * outline.radius_px + 20.0;
  for (const Vector2d& corner :
       {Vector2d(start - wide * aside), Vector2d(start - wide * aside + deep * out),
        Vector2d(start + wide * aside + deep * out), Vector2d(start + wide * aside)}) {
    body.corners.push_back(scale * (corner - centre));
  }
  // In order from x to y, as Body requires.
  const Vector2d a = body.corners[1] - body.corners[0];
  const Vector2d b = body.corners[2] - body.corners[1];
  if (a.x() * b.y() - a.y() * b.x() < 0.0) {
    std::reverse(body.corners.begin(), body.corners.end());
  }
  return body;
}

// Adds the corners of `plate`, scaled from its clutter size to `radius`.
void AddScaled(const features::TargetFeature& plate, double radius, std::vector<Vector2d>& corners) {
  for (const Vector2d& corner : vision::FlatCorners(plate.corners)) {
    corners.emplace_back(corner * (radius / SizeOf(plate).clutter));
  }
}

// Adds objects that differ from the target in colour, shape or size. None of them hides it.
void AddClutter(PictureScene& scene, TargetKind kind, Chance& chance) {
  constexpr int kThings = 9;
  const PictureCamera& camera = scene.camera;
  const TrueOutline target =
      scene.has_target ? OutlineOf(camera, scene.bodies.front()) : TrueOutline{-1e4, -1e4, 0.0, {}};
  const bool is_round = features::TraitsOf(kind).body != features::TargetBody::kPlate;
  const bool is_triangle = features::TraitsOf(kind).num_corners == 3;
  const features::TargetFeature triangle = TargetOf(TargetKind::kTriangle);
  const features::TargetFeature plate = is_round ? triangle : TargetOf(kind);
  for (int i = 0; i < kThings; ++i) {
    Body body;
    const int sort = i % 3;
    const double radius_px = sort == 2 ? chance.Between(3.0, 6.5) : chance.Between(18.0, 70.0);
    body.p.z() = 3.0 + 0.01 * i;  // behind every target
    const double radius = radius_px * body.p.z() / camera.f_px;
    const double u = chance.Between(0.0, camera.width_px);
    const double v = chance.Between(0.0, camera.height_px);
    if (std::hypot(u - target.u_px, v - target.v_px) < 2.2 * target.radius_px + 2.0 * radius_px + 6.0) {
      continue;
    }
    body.p.x() = (u - camera.c_u_px) * body.p.z() / camera.f_px;
    body.p.y() = (v - camera.c_v_px) * body.p.z() / camera.f_px;
    const Vector3d same(30.0, 35.0, 190.0);
    const Vector3d others[] = {{190.0, 60.0, 30.0}, {50.0, 180.0, 60.0}, {170.0, 170.0, 170.0}};
    const bool round = sort == 0 ? is_round : sort == 1 ? !is_round : is_round;
    body.bgr = sort == 0 ? others[static_cast<std::size_t>(chance.Between(0.0, 2.999))] : same;
    if (round) {
      body.shape = Shape::kDisc;
      body.radius = radius;
    } else {
      body.shape = Shape::kPolygon;
      // The target's shape in another colour, or another shape: a long bar or a triangle.
      if (sort == 0) {
        AddScaled(plate, radius, body.corners);
      } else if (is_triangle || (is_round && chance.Coin())) {
        body.corners = {{-1.6 * radius, -0.4 * radius},
                        {1.6 * radius, -0.4 * radius},
                        {1.6 * radius, 0.4 * radius},
                        {-1.6 * radius, 0.4 * radius}};
      } else {
        AddScaled(triangle, radius, body.corners);
      }
      body.R = Turn(chance, 0.3);
    }
    scene.bodies.push_back(body);
  }
}

}  // namespace

const std::vector<SceneClass>& SceneClasses() {
  static const std::vector<SceneClass> classes{
      {.name = "clean", .goal_px = 0.01},
      {.name = "noise-5", .noise = 5.0},
      {.name = "noise-15", .noise = 15.0, .goal_px = 0.03},
      {.name = "noise-30", .noise = 30.0},
      {.name = "blur", .noise = 3.0, .blur_px = 2.0},
      {.name = "low-contrast", .noise = 3.0, .contrast_min = 20.0, .contrast_max = 20.0},
      {.name = "occluded", .noise = 3.0, .hidden = 0.3, .goal_px = 0.03},
      {.name = "clutter", .noise = 3.0, .clutter = true},
      {.name = "off-axis", .noise = 3.0, .off_axis = true},
  };
  return classes;
}

features::TargetFeature TargetOf(TargetKind kind) {
  config::TargetSettings settings;
  settings.kind = features::TraitsOf(kind).name;
  settings.diameter = kDiameter;
  settings.side = kSide;
  settings.triangle.assign(kTriangle.begin(), kTriangle.end());
  return config::MakeTarget(settings);
}

PictureScene MakeScene(const SceneClass& c, TargetKind kind, bool with_target, unsigned seed) {
  Chance chance(seed);
  PictureScene scene;
  scene.seed = seed;
  scene.noise = c.noise;
  scene.blur_px = c.blur_px;
  scene.gray = !c.clutter;
  scene.has_target = with_target;
  const double ground = chance.Between(60.0, 100.0);
  scene.ground_bgr.setConstant(ground);
  scene.ground_swing = std::min(10.0, 0.2 * c.contrast_min);
  if (with_target) {
    Body target = MakeTarget(kind, scene.camera, c.off_axis, chance);
    const double contrast = chance.Between(c.contrast_min, c.contrast_max);
    const bool dark = contrast < 50.0 && chance.Coin();
    target.bgr.setConstant(dark ? ground - contrast : ground + contrast);
    if (c.clutter) {
      target.bgr = Vector3d(30.0, 35.0, 190.0);
    }
    scene.bodies.push_back(target);
    if (c.hidden > 0.0) {
      Body occluder = MakeOccluder(scene.camera, target, c.hidden, chance);
      occluder.bgr.setConstant(chance.Coin() ? 20.0 : 0.5 * (ground + target.bgr.mean()));
      scene.bodies.push_back(occluder);
    }
  } else if (c.hidden > 0.0) {
    const Body ghost = MakeTarget(kind, scene.camera, false, chance);
    Body occluder = MakeOccluder(scene.camera, ghost, c.hidden, chance);
    occluder.bgr.setConstant(20.0);
    scene.bodies.push_back(occluder);
  }
  if (c.clutter) {
    AddClutter(scene, kind, chance);
  }
  return scene;
}

}  // namespace fovea::bench
