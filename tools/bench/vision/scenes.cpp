#include "tools/bench/vision/scenes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "firmware/core/features/target_traits.hpp"

namespace fovea::bench {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kRadiusMinPx = 12.0;
constexpr double kRadiusMaxPx = 150.0;

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

std::vector<Vector2d> SquareCorners(double side) {
  const double h = 0.5 * side;
  return {{-h, -h}, {h, -h}, {h, h}, {-h, h}};
}

Body MakeTarget(TargetKind kind, const PictureCamera& camera, bool off_axis, Chance& chance) {
  Body body;
  double radius = 0.5 * kDiameter;
  double reach = 1.0;  // of the furthest point of the outline, in radii
  switch (kind) {
    case TargetKind::kSphere:
      body.radius = radius;
      body.shade = off_axis ? 0.4 : 0.0;
      break;
    case TargetKind::kCircle:
      body.shape = Shape::kDisc;
      body.radius = radius;
      body.R = Turn(chance, 0.9);
      break;
    case TargetKind::kSquare:
      body.shape = Shape::kPolygon;
      body.corners = SquareCorners(kSide);
      body.R = Turn(chance, 0.7);
      radius = kSide / std::sqrt(std::numbers::pi);
      reach = 1.4;
      break;
    case TargetKind::kTriangle:
      body.shape = Shape::kPolygon;
      body.corners = TriangleCorners();
      body.R = Turn(chance, 0.7);
      radius = 0.0416;
      reach = 1.9;
      break;
  }
  const bool flat = features::TraitsOf(kind).body == features::TargetBody::kPlate;
  const double least = flat ? 20.0 : kRadiusMinPx;
  const double most = off_axis ? 80.0 : flat ? 100.0 : kRadiusMaxPx;
  const double radius_px = least * std::pow(most / least, chance.Between(0.0, 1.0));
  body.p.z() = camera.f_px * radius / radius_px;
  // Off the axis outlines are longer: room for them, and for the lines across them.
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

// A bar before the target that hides the share `hidden` of its outline.
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
  const double edge = *at;  // as many of the outline's points are further out
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
  // Turning from x to y.
  const Vector2d a = body.corners[1] - body.corners[0];
  const Vector2d b = body.corners[2] - body.corners[1];
  if (a.x() * b.y() - a.y() * b.x() < 0.0) {
    std::reverse(body.corners.begin(), body.corners.end());
  }
  return body;
}

// Things that differ from the target in colour, shape or size, not before it.
void AddClutter(PictureScene& scene, TargetKind kind, Chance& chance) {
  constexpr int kThings = 9;
  const PictureCamera& camera = scene.camera;
  const TrueOutline target =
      scene.has_target ? OutlineOf(camera, scene.bodies.front()) : TrueOutline{-1e4, -1e4, 0.0, {}};
  const bool is_round = features::TraitsOf(kind).body != features::TargetBody::kPlate;
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
      // Of another shape than the target's: a long bar, or the other polygon.
      if (sort == 0) {
        body.corners = kind == TargetKind::kSquare ? SquareCorners(1.6 * radius) : TriangleCorners();
        for (Vector2d& corner : body.corners) {
          corner *= kind == TargetKind::kSquare ? 1.0 : radius / 0.0416;
        }
      } else if (kind == TargetKind::kTriangle || (is_round && chance.Coin())) {
        body.corners = {{-1.6 * radius, -0.4 * radius},
                        {1.6 * radius, -0.4 * radius},
                        {1.6 * radius, 0.4 * radius},
                        {-1.6 * radius, 0.4 * radius}};
      } else {
        for (const Vector2d& corner : TriangleCorners()) {
          body.corners.emplace_back(corner * (radius / 0.0416));
        }
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

const std::vector<Vector2d>& TriangleCorners() {
  static const std::vector<Vector2d> corners = [] {
    std::vector<Vector2d> list{{-0.05, 0.04}, {-0.02, -0.06}, {0.06, 0.03}};
    const Vector2d mean = (list[0] + list[1] + list[2]) / 3.0;
    for (Vector2d& corner : list) {
      corner -= mean;
    }
    return list;
  }();
  return corners;
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
