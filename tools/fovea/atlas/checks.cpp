// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/checks.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/core/barriers/line_of_sight_barrier.hpp"
#include "firmware/core/barriers/singularity.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "tools/fovea/atlas/bench.hpp"

namespace fovea::atlas {
namespace {

using model::ArmShape;
using model::Capsule;
using model::Pose;
using model::Vec3;

constexpr double kEdgePx = 30.0;
constexpr int kPerSide = 4;  // points of a flat target's side that are looked at
// Along a path.
constexpr double kDepthOnTheWay = 0.05;  // [m]
constexpr double kSteepest = 0.2;        // cosine of a plate's tilt
// Of the links, only these may come near a plane: those before them stand on the table.
constexpr std::size_t kOuterLinks = 4;

// The target's centre [m]; of a flat one, also points of its sides and between them and the centre.
std::vector<Vec3> PointsOf(const features::TargetOutline& outline, const Pose& X_BO) {
  std::vector<Vec3> points{X_BO.p};
  for (int i = 0; outline.num_points > 1 && i < outline.num_points; ++i) {
    const Vec3 from = X_BO * outline.p_OP[static_cast<std::size_t>(i)];
    const Vec3 to = X_BO * outline.p_OP[static_cast<std::size_t>((i + 1) % outline.num_points)];
    for (int k = 0; k < kPerSide; ++k) {
      points.push_back(from + k * (to - from) / kPerSide);
      points.push_back(0.5 * (points.back() + X_BO.p));
    }
  }
  return points;
}

// A segment's point nearest to `p`, as a share of the way from `a` to `b`.
double ShareOf(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double length2 = ab.squaredNorm();
  return length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
}

double DistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  return (p - a - ShareOf(p, a, b) * (b - a)).norm();
}

// Whether two segments are nearer to each other than `bound`: by alternating projections onto the two convex
// sets, which converge to their distance from above. Starts at both ends and in the middle make a few rounds
// enough.
bool AreNearer(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double bound) {
  constexpr int kRounds = 8;
  const double reach = 0.5 * ((b - a).norm() + (d - c).norm());
  if (0.5 * (a + b - c - d).norm() - reach > bound) {
    return false;
  }
  if (DistanceToSegment(c, a, b) < bound || DistanceToSegment(d, a, b) < bound) {
    return true;
  }
  for (const double from : {0.0, 0.5, 1.0}) {
    Vec3 p = a + from * (b - a);
    for (int round = 0; round < kRounds; ++round) {
      const Vec3 other = c + ShareOf(p, c, d) * (d - c);
      if ((p - other).norm() < bound) {
        return true;
      }
      p = a + ShareOf(other, a, b) * (b - a);
    }
  }
  return false;
}

double DistanceToBox(const Vec3& p, const config::Box& box) {
  return (p - p.cwiseMax(box.low).cwiseMin(box.high)).norm();
}

// Whether the segment is nearer to one of the boxes than `bound`. Its distance is convex along the segment,
// so thirds without the minimum are cut off until a point is near enough, or what is left is short.
bool IsNearABox(const std::vector<config::Box>& boxes, const Vec3& a, const Vec3& b, double bound) {
  constexpr double kShort = 1e-4;  // [m]
  const auto is_near = [&](const config::Box& box) {
    const double length = (b - a).norm();
    if (DistanceToBox(0.5 * (a + b), box) - 0.5 * length >= bound) {
      return false;
    }
    double from = 0.0;
    double to = 1.0;
    do {
      const double one = from + (to - from) / 3.0;
      const double other = to - (to - from) / 3.0;
      const double at_one = DistanceToBox(a + one * (b - a), box);
      const double at_other = DistanceToBox(a + other * (b - a), box);
      if (std::min(at_one, at_other) < bound) {
        return true;
      }
      (at_one < at_other ? to : from) = at_one < at_other ? other : one;
    } while ((to - from) * length > kShort);
    return false;
  };
  return std::any_of(boxes.begin(), boxes.end(), is_near);
}

}  // namespace

StartChecks::StartChecks(const Scene& scene) : scene_(scene), boxes_(scene.boxes) {
  const config::Obstacles& known = scene.servo.guard.obstacles;
  boxes_.insert(boxes_.end(), known.boxes.begin(), known.boxes.begin() + known.num_boxes);
}

const StartChecks::Clear StartChecks::kAtEnds{.margins = 2.0,
                                              .workspace = 0.003,
                                              .links = 0.02,
                                              .hand = 0.04,
                                              .hand_ball = 0.03,
                                              .sight = 0.02,
                                              .itself = 0.02,
                                              .target = 0.03,
                                              .things = 0.01};
// What the guard proves each stop to keep, and 1 mm: between tested postures, 0.1 rad apart, the hand comes
// nearer to a plane by that much.
const StartChecks::Clear StartChecks::kOnTheWay{.margins = 1.0,
                                                .workspace = 0.001,
                                                .links = 0.001,
                                                .hand = 0.001,
                                                .hand_ball = 0.0,
                                                .sight = 0.0,
                                                .itself = 0.0,
                                                .target = 0.001,
                                                .things = 0.001};

StartPosture StartChecks::At(const model::VecN& q) const {
  const config::ServoConfig& servo = scene_.servo;
  StartPosture posture;
  posture.q = q;
  model::ComputePoses(servo.arm, q, posture.poses);
  posture.X_BC = posture.poses.X_BE * servo.X_EC;
  posture.bodies.push_back(servo.arm.shape.bodies[0]);
  for (std::size_t i = 0; i < static_cast<std::size_t>(servo.arm.num_joints); ++i) {
    const Capsule& body = servo.arm.shape.bodies[i + 1];
    const Pose& X_BL = posture.poses.X_BL[i];
    posture.bodies.push_back({X_BL * body.p_LA, X_BL * body.p_LB, body.radius});
  }
  return posture;
}

bool StartChecks::InsideBarrier(const StartPosture& posture, const Clear& clear) const {
  const config::GuardConfig& guard = scene_.servo.guard;
  return posture.poses.X_BE.p.norm() <= guard.workspace_radius - guard.workspace_margin - clear.workspace;
}

bool StartChecks::ClearOfSolids(const StartPosture& posture, const Clear& clear) const {
  const config::GuardConfig& guard = scene_.servo.guard;
  const double margin = clear.margins * guard.workspace_margin;
  const config::Obstacles& solids = guard.obstacles;
  const auto hand_is_clear = [&](const Vec3& p_B, double radius) {
    const double least = radius + margin + clear.hand;
    for (int i = 0; i < solids.num_planes; ++i) {
      const config::Plane& plane = solids.planes[static_cast<std::size_t>(i)];
      if (plane.normal.dot(p_B) - plane.distance < least) {
        return false;
      }
    }
    return std::none_of(boxes_.begin(), boxes_.end(),
                        [&](const config::Box& box) { return DistanceToBox(p_B, box) < least; });
  };
  for (int i = 0; i < guard.hand.num_balls; ++i) {
    const auto& ball = guard.hand.balls[static_cast<std::size_t>(i)];
    if (!hand_is_clear(posture.poses.X_BE * ball.p_EP, ball.radius)) {
      return false;
    }
  }
  const double least = guard.link_clearance + margin + clear.links;
  const std::size_t links = std::min(kOuterLinks, posture.bodies.size() - 1);
  for (auto body = posture.bodies.end() - static_cast<std::ptrdiff_t>(links); body != posture.bodies.end();
       ++body) {
    for (int i = 0; i < solids.num_planes; ++i) {
      const config::Plane& plane = solids.planes[static_cast<std::size_t>(i)];
      const double nearest = std::min(plane.normal.dot(body->p_LA), plane.normal.dot(body->p_LB));
      if (nearest - plane.distance - body->radius < least) {
        return false;
      }
    }
  }
  for (auto body = posture.bodies.begin() + 1; body != posture.bodies.end(); ++body) {
    if (IsNearABox(boxes_, body->p_LA, body->p_LB, body->radius + least)) {
      return false;
    }
  }
  return hand_is_clear(posture.poses.X_BE.p, clear.hand_ball) &&
         (clear.hand_ball == 0.0 || hand_is_clear(posture.X_BC.p, clear.hand_ball));
}

// Along each axis of the picture, a ball's outline ends at the tangents to the ball (exact, also off axis).
bool StartChecks::InPicture(const Pose& X_CO, double edge_px) const {
  const vision::Intrinsics& camera = scene_.camera;
  const features::TargetOutline outline = scene_.servo.feature.Outline();
  const auto inside = [&](double across, double depth, double f_px, double c_px, double size_px) {
    const double at = std::atan2(across, depth);
    const double half = std::asin(std::min(outline.radius / std::hypot(across, depth), 1.0));
    return std::fabs(at) + half < 0.5 * std::numbers::pi && c_px + f_px * std::tan(at - half) >= edge_px &&
           c_px + f_px * std::tan(at + half) <= size_px - 1.0 - edge_px;
  };
  for (int i = 0; i < outline.num_points; ++i) {
    const Vec3 p = X_CO * outline.p_OP[static_cast<std::size_t>(i)];
    if (!inside(p.x(), p.z(), camera.f_u_px, camera.c_u_px, camera.width_px) ||
        !inside(p.y(), p.z(), camera.f_v_px, camera.c_v_px, camera.height_px)) {
      return false;
    }
  }
  return true;
}

bool StartChecks::TargetAboveTable(const Pose& X_BO) const {
  const features::TargetOutline outline = scene_.servo.feature.Outline();
  for (int i = 0; i < outline.num_points; ++i) {
    if ((X_BO * outline.p_OP[static_cast<std::size_t>(i)]).z() < outline.radius) {
      return false;
    }
  }
  return true;
}

// Keeps apart: the pairs of links that could touch; target and whole arm; lines of sight and all links except
// the last, which move with the camera.
bool StartChecks::ArmInTheWay(const StartPosture& posture, const Pose& X_BO, const Clear& clear) const {
  const config::ServoConfig& servo = scene_.servo;
  const ArmShape& shape = servo.arm.shape;
  for (int i = 0; i < shape.num_pairs; ++i) {
    const ArmShape::Pair& pair = shape.pairs[static_cast<std::size_t>(i)];
    const Capsule& one = posture.bodies[static_cast<std::size_t>(pair.near)];
    const Capsule& other = posture.bodies[static_cast<std::size_t>(pair.far)];
    if (AreNearer(one.p_LA, one.p_LB, other.p_LA, other.p_LB,
                  one.radius + other.radius + servo.guard.self_clearance + clear.itself)) {
      return true;
    }
  }
  const features::TargetOutline outline = servo.feature.Outline();
  std::vector<Vec3> points{X_BO.p};
  for (int k = 0; k < outline.num_points; ++k) {
    points.push_back(X_BO * outline.p_OP[static_cast<std::size_t>(k)]);
  }
  for (const Vec3& p_BP : points) {
    const auto near = [&](const Vec3& a, const Vec3& b, double radius) {
      return DistanceToSegment(p_BP, a, b) - radius - outline.radius < clear.target;
    };
    for (std::size_t i = 0; i < posture.bodies.size(); ++i) {
      const Capsule& body = posture.bodies[i];
      const bool could_hide = i + ArmShape::kNeighbours + 1 < posture.bodies.size();
      if (near(body.p_LA, body.p_LB, body.radius) ||
          (could_hide &&
           AreNearer(posture.X_BC.p, p_BP, body.p_LA, body.p_LB,
                     body.radius + barriers::kHousing + servo.guard.sight_clearance + clear.sight))) {
        return true;
      }
    }
    if (clear.hand_ball > 0.0) {
      if (near(posture.poses.X_BE.p, posture.X_BC.p, clear.hand_ball)) {
        return true;
      }
      continue;
    }
    for (int i = 0; i < servo.guard.hand.num_balls; ++i) {
      const auto& ball = servo.guard.hand.balls[static_cast<std::size_t>(i)];
      const Vec3 p_B = posture.poses.X_BE * ball.p_EP;
      if (near(p_B, p_B, ball.radius)) {
        return true;
      }
    }
  }
  return false;
}

// The servo lets a box be near the last tenth of a line of sight.
bool StartChecks::BenchInTheWay(const StartPosture& posture, const Pose& X_BO, const Clear& clear) const {
  constexpr double kShare = 0.9;
  const features::TargetOutline outline = scene_.servo.feature.Outline();
  const std::vector<Vec3> points = PointsOf(outline, X_BO);
  return std::any_of(points.begin(), points.end(), [&](const Vec3& p_BP) {
    const Vec3 p_before = posture.X_BC.p + kShare * (p_BP - posture.X_BC.p);
    return ThingInTheWay(posture.X_BC.p, p_BP, clear.things + outline.radius) ||
           IsNearABox(boxes_, posture.X_BC.p, p_before, scene_.servo.guard.sight_clearance + clear.sight) ||
           IsNearABox(boxes_, p_BP, p_BP, outline.radius + clear.target);
  });
}

// Whether a drawn solid of the arm hides a point of the target or, of a ball, of the circle that the camera
// sees as its outline.
bool StartChecks::IsHidden(const StartPosture& posture, const Pose& X_BO) const {
  constexpr int kAround = 16;
  const features::TargetOutline outline = scene_.servo.feature.Outline();
  const Vec3& p_BC = posture.X_BC.p;
  std::vector<Vec3> points = PointsOf(outline, X_BO);
  if (outline.radius > 0.0) {
    const Vec3 away = X_BO.p - p_BC;
    const double share = std::pow(outline.radius / away.norm(), 2);
    const Vec3 across = outline.radius * std::sqrt(std::max(1.0 - share, 0.0)) * away.unitOrthogonal();
    const Vec3 along = away.normalized().cross(across);
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kAround;
      points.push_back(X_BO.p - share * away + std::cos(angle) * across + std::sin(angle) * along);
    }
  }
  return scene_.drawn->Hides(posture.q, p_BC, points);
}

bool StartChecks::InsideBarrier(const StartPosture& posture) const { return InsideBarrier(posture, kAtEnds); }

bool StartChecks::ClearOfSolids(const StartPosture& posture) const { return ClearOfSolids(posture, kAtEnds); }

bool StartChecks::InPicture(const Pose& X_CO) const { return InPicture(X_CO, kEdgePx); }

bool StartChecks::InReach(const Pose& X_CO) const {
  const double distance = X_CO.p.norm();
  return distance >= scene_.reach.nearest && distance <= scene_.reach.farthest;
}

bool StartChecks::ArmInTheWay(const StartPosture& posture, const Pose& X_BO) const {
  return ArmInTheWay(posture, X_BO, kAtEnds) || IsHidden(posture, X_BO);
}

bool StartChecks::BenchInTheWay(const StartPosture& posture, const Pose& X_BO) const {
  return BenchInTheWay(posture, X_BO, kAtEnds);
}

// The servo's bound, by the singular values of all of the Jacobian.
bool StartChecks::IsRegular(const StartPosture& posture) const {
  const config::ServoConfig& servo = scene_.servo;
  model::Mat6N J;
  model::ComputeJacobian(servo.arm, posture.poses, servo.X_EC, J);
  J.topRows<3>() /= barriers::SingularityConfig{}.length;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd{Eigen::MatrixXd(J)};
  return svd.singularValues().minCoeff() > servo.guard.singularity_min;
}

bool StartChecks::StandsAtGoal(const StartPosture& posture, const Pose& X_BO) const {
  return IsRegular(posture) && CosineTo(posture, X_BO) > LeastCosine() && InsideBarrier(posture) &&
         ClearOfSolids(posture) && !ArmInTheWay(posture, X_BO) && !BenchInTheWay(posture, X_BO);
}

bool StartChecks::StandsAtGoalByServo(const StartPosture& posture, const Pose& X_BO) const {
  return IsRegular(posture) && OnTheWay(posture, X_BO, LeastCosine());
}

double StartChecks::CosineTo(const StartPosture& posture, const Pose& X_BO) const {
  if (features::TraitsOf(scene_.servo.feature.target).body == features::TargetBody::kBall) {
    return 1.0;
  }
  const Pose X_CO = posture.X_BC.Inverse() * X_BO;
  return X_CO.R.col(2).dot(X_CO.p) / X_CO.p.norm();
}

double StartChecks::LeastCosine() const {
  const bool is_disc = features::TraitsOf(scene_.servo.feature.target).body == features::TargetBody::kDisc;
  return is_disc ? scene_.servo.guard.view.disc_cosine_min : kSteepest;
}

bool StartChecks::OnTheWay(const StartPosture& posture, const Pose& X_BO, double least_cosine) const {
  const Pose X_CO = posture.X_BC.Inverse() * X_BO;
  return X_CO.p.z() > kDepthOnTheWay && CosineTo(posture, X_BO) > least_cosine && !OutOfViewOnTheWay(X_CO) &&
         InsideBarrier(posture, kOnTheWay) && ClearOfSolids(posture, kOnTheWay) &&
         !ArmInTheWay(posture, X_BO, kOnTheWay) && !BenchInTheWay(posture, X_BO, kOnTheWay) &&
         !IsHidden(posture, X_BO);
}

// By the servo's bounds, for which a ball reaches r / z in the image. Without them: by the picture's edges.
bool StartChecks::OutOfViewOnTheWay(const Pose& X_CO) const {
  if (!(X_CO.p.z() > kDepthOnTheWay)) {
    return false;
  }
  const config::ViewConfig& view = scene_.servo.guard.view;
  if (!view.enabled) {
    return !InPicture(X_CO, 0.0);
  }
  const features::TargetOutline outline = scene_.servo.feature.Outline();
  for (int i = 0; i < outline.num_points; ++i) {
    const Vec3 p = X_CO * outline.p_OP[static_cast<std::size_t>(i)];
    const double x = p.x() / p.z();
    const double y = p.y() / p.z();
    const double reach = outline.radius / p.z();
    if (!(p.z() > 0.0 && x - reach >= view.x_min && x + reach <= view.x_max && y - reach >= view.y_min &&
          y + reach <= view.y_max)) {
      return true;
    }
  }
  return false;
}

}  // namespace fovea::atlas
