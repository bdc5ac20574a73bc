// SPDX-License-Identifier: Apache-2.0
#include "sim/scenario/target_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "firmware/core/features/target_traits.hpp"
#include "firmware/host/config/input_error.hpp"
#include "firmware/vision/pose/flat_corners.hpp"
#include "sim/scenario/roll_pitch_yaw.hpp"

namespace fovea::sim {
namespace {

// In the order of MotionKind.
constexpr std::array<const char*, 8> kMotionNames{"still",    "circle", "line", "eight",
                                                  "pendulum", "wander", "jump", "pushed"};

}  // namespace

void AddTargetSceneKeys(TargetScene& s, config::KeyTable& keys) {
  config::AddTargetKeys(s, keys);
  keys.Numbers("target.position", s.position, 3, 3, -5.0, 5.0, "m",
               "its centre in B, or the centre of its path");
  keys.Numbers(
      "target.rpy_deg", s.rpy_deg, 3, 3, -360.0, 360.0, "deg",
      "roll, pitch, yaw of a flat target about fixed axes of B; its frame: x right and y down on its painted "
      "side, z into it");
  keys.Numbers("target.colour", s.colour, 3, 3, 0.0, 1.0, "",
               "red, green, blue; also sets vision.hue_deg, unless that key is given");
  keys.Choice(
      "target.motion", s.motion, {kMotionNames.begin(), kMotionNames.end()},
      "how it moves; circle and eight: horizontal; pendulum: swings by 0.5 rad; wander: smooth random path "
      "by run.seed; pushed: a ball on the table that rolls, by physics");
  keys.Number(
      "target.path_radius", s.path_radius, 0.001, 2.0, "m",
      "radius of the circle; half length of line and eight; largest distance of wander from its centre; "
      "length of the pendulum");
  keys.Number("target.path_yaw_deg", s.path_yaw_deg, -360.0, 360.0, "deg",
              "direction of line, eight and pendulum in B: 0 along x, 90 along y");
  keys.Number("target.speed", s.speed, 0.0, 5.0, "m/s", "largest speed along the path");
  keys.Numbers("target.jump", s.jump, 3, 3, -1.0, 1.0, "m", "displacement of the jump, in B");
  keys.Number("target.jump_s", s.jump_s, 0.0, 1e6, "s", "time of the jump");
  keys.Numbers("target.push", s.push, 3, 3, -100.0, 100.0, "N s",
               "impulse of the push through a ball's centre, in B");
  keys.Number("target.push_s", s.push_s, 0.0, 1e6, "s", "time of the push");
  keys.Number("target.mass", s.mass, 1e-3, 100.0, "kg", "mass of a pushed ball");
  keys.Number("target.friction", s.friction, 0.0, 10.0, "", "friction of a pushed ball with the table");
  keys.Number("target.rolling_resistance", s.rolling_resistance, 0.0, 1.0, "m",
              "the torque against the ball's rolling is the normal force times this");
  keys.Number("target.air_damping", s.air_damping, 0.0, 0.999, "1/s",
              "share of the ball's speed lost to the air");
  keys.Number("target.turn_deg_s", s.turn_deg_s, -360.0, 360.0, "deg/s",
              "turn rate of a flat target about its normal");
  keys.Flag("target.clutter", s.clutter, "add similar things to the bench");
}

TargetMotion MakeTargetMotion(const TargetScene& s, std::uint64_t seed) {
  const double yaw = kRadPerDeg * s.path_yaw_deg;
  TargetMotion motion;
  const auto* name = std::find(kMotionNames.begin(), kMotionNames.end(), s.motion);
  motion.kind = static_cast<MotionKind>(name - kMotionNames.begin());
  motion.p_BO = Eigen::Vector3d(s.position[0], s.position[1], s.position[2]);
  motion.reach = s.path_radius;
  motion.speed = s.speed;
  motion.direction = Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
  motion.jump = Eigen::Vector3d(s.jump[0], s.jump[1], s.jump[2]);
  motion.jump_s = s.jump_s;
  motion.seed = seed;
  motion.R_BO = RollPitchYaw(s.rpy_deg).toRotationMatrix();
  motion.turn_rate = kRadPerDeg * s.turn_deg_s;
  return motion;
}

RollingBallConfig MakeRollingBall(const TargetScene& s) {
  RollingBallConfig ball;
  if (s.motion != "pushed") {
    return ball;
  }
  ball.p_BO = Eigen::Vector3d(s.position[0], s.position[1], s.position[2]);
  ball.radius = 0.5 * s.diameter;
  const features::TargetTraits* traits = features::FindTraits(s.kind);
  if (traits == nullptr || traits->body != features::TargetBody::kBall) {
    throw config::InputError(fmt::format(
        "target.motion = \"pushed\" is not allowed for target.kind = \"{}\": only a sphere rolls", s.kind));
  }
  if (ball.p_BO.z() < ball.radius) {
    throw config::InputError(
        fmt::format("target.position[2] = {} is not allowed with target.motion = \"pushed\": the ball lies "
                    "on the table at {} m",
                    ball.p_BO.z(), ball.radius));
  }
  ball.mass = s.mass;
  ball.friction = s.friction;
  ball.rolling_resistance = s.rolling_resistance;
  ball.air_damping = s.air_damping;
  return ball;
}

TargetShape MakeTargetShape(const features::TargetFeature& feature) {
  TargetShape shape;
  shape.radius = feature.radius;
  if (features::TraitsOf(feature.target).body == features::TargetBody::kDisc) {
    shape.kind = TargetShape::Kind::kDisc;
  } else if (feature.SeesOrientation()) {
    shape.kind = TargetShape::Kind::kPolygon;
    shape.corners = vision::FlatCorners(feature.corners);
  }
  return shape;
}

Shape MakeTargetBody(const TargetShape& shape) {
  constexpr float kThickness = 0.002F;
  constexpr int kDiscCorners = 48;
  Shape body;
  if (shape.kind == TargetShape::Kind::kBall) {
    body.kind = ShapeKind::kSphere;
    body.size = {shape.radius, 0.0, 0.0};
    return body;
  }
  std::vector<Eigen::Vector2d> corners = shape.corners;
  for (int i = 0; shape.kind == TargetShape::Kind::kDisc && i < kDiscCorners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kDiscCorners;
    corners.emplace_back(shape.radius * std::cos(angle), shape.radius * std::sin(angle));
  }
  Mesh plate;
  for (const Eigen::Vector2d& corner : corners) {
    for (const float z : {0.0F, kThickness}) {
      const Eigen::Vector3f position(static_cast<float>(corner.x()), static_cast<float>(corner.y()), z);
      plate.vertices.push_back({position, Eigen::Vector3f::UnitZ(), Eigen::Vector3f::Zero()});
    }
  }
  body.kind = ShapeKind::kMesh;
  body.mesh = std::make_shared<const Mesh>(std::move(plate));
  return body;
}

// The hue of HSV. (Smith, Color gamut transform pairs, 1978.)
std::optional<double> HueOfColour(const std::vector<double>& rgb) {
  const auto [low, high] = std::minmax_element(rgb.begin(), rgb.end());
  const double range = *high - *low;
  if (!(range > 0.0)) {
    return std::nullopt;
  }
  const auto strongest = high - rgb.begin();
  const double next = rgb[static_cast<std::size_t>((strongest + 1) % 3)];
  const double last = rgb[static_cast<std::size_t>((strongest + 2) % 3)];
  const double hue = 120.0 * static_cast<double>(strongest) + 60.0 * (next - last) / range;
  return hue < 0.0 ? hue + 360.0 : hue;
}

bool KeepsMoving(const TargetScene& scene) {
  return (scene.motion != "still" && scene.motion != "jump" && scene.motion != "pushed") ||
         scene.turn_deg_s != 0.0;
}

}  // namespace fovea::sim
