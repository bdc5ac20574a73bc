// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/atlas/checks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/core/model/rotation.hpp"
#include "tools/fovea/atlas/bench.hpp"

namespace fovea::atlas {
namespace {

using model::Pose;
using model::Vec3;
using model::VecN;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kHfovDeg = 60.0;
constexpr double kEdgePx = 30.0;
constexpr double kRadius = 0.845;  // 3 mm inside the servo's bound, workspace_radius - workspace_margin [m]
constexpr double kAboveTable = 0.10;  // [m]
constexpr double kThingClear = 0.01;  // distance of things from the lines of sight and the target [m]
// Along a path: the bounds that the servo itself keeps.
constexpr double kEdgeOnTheWayPx = 10.0;
constexpr double kAboveTableOnTheWay = 0.09;  // [m]
constexpr double kDepthOnTheWay = 0.05;       // [m]
constexpr double kSteepest = 0.2;             // cosine between a flat target's normal and the line of sight
constexpr int kUpperLinks = 6;                // segments up to the forearm: not in a line of sight
constexpr int kTrunkLinks = 3;                // segments up to the elbow: not near the hand

double DistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * ab).norm();
}

// Approximate, from points along the first segment. Accurate enough for something as thick as an arm.
double DistanceOfSegments(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  constexpr int kPoints = 20;
  double least = DistanceToSegment(a, c, d);
  for (int i = 1; i <= kPoints; ++i) {
    least = std::min(least, DistanceToSegment(a + (b - a) * i / kPoints, c, d));
  }
  return least;
}

}  // namespace

double FocalPx() { return 0.5 * kWidthPx / std::tan(0.5 * kHfovDeg * kRadPerDeg); }
double U(const Vec3& p_C) { return 0.5 * (kWidthPx - 1.0) + FocalPx() * p_C.x() / p_C.z(); }
double V(const Vec3& p_C) { return 0.5 * (kHeightPx - 1.0) + FocalPx() * p_C.y() / p_C.z(); }

const StartChecks::Clear StartChecks::kAtEnds{0.10, 0.15, 0.15};
const StartChecks::Clear StartChecks::kOnTheWay{0.08, 0.10, 0.13};

StartChecks::StartChecks(const model::ArmModel& arm, const features::TargetFeature& feature)
    : arm_(arm), feature_(feature) {
  X_EC_.R = model::RotationOf({0.0, 0.0, 0.5 * std::numbers::pi});
  X_EC_.p = {0.05, 0.0, 0.04};
}

StartPosture StartChecks::At(const VecN& q) const {
  StartPosture posture;
  posture.q = q;
  model::ComputePoses(arm_, q, posture.poses);
  posture.X_BC = posture.poses.X_BE * X_EC_;
  return posture;
}

bool StartChecks::InsideBarrier(const StartPosture& posture) const {
  return posture.poses.X_BE.p.norm() <= kRadius;
}

// The start of the forearm's axis, beside the elbow joint (a_5 in the Panda's table).
Vec3 StartChecks::ForearmStart(const StartPosture& posture) const {
  const Pose& X_BL4 = posture.poses.X_BL[3];
  return X_BL4 * Vec3(arm_.joints[4].X_PJ.p.x(), 0.0, 0.0);
}

bool StartChecks::AboveTable(const StartPosture& posture, double height) const {
  double lowest = std::min({posture.poses.X_BE.p.z(), posture.X_BC.p.z(), ForearmStart(posture).z()});
  for (int i = 3; i < arm_.num_joints; ++i) {  // the links before it stand on the table
    lowest = std::min(lowest, posture.poses.X_BL[static_cast<std::size_t>(i)].p.z());
  }
  return lowest >= height;
}

// Along each axis of the picture, a ball's outline ends at the tangents to the ball (exact, also off axis).
bool StartChecks::InPicture(const Pose& X_CO, double edge_px) const {
  const features::TargetOutline outline = feature_.Outline();
  const auto inside = [&](double across, double depth, double size_px) {
    const double at = std::atan2(across, depth);
    const double half = std::asin(std::min(outline.radius / std::hypot(across, depth), 1.0));
    const double most = FocalPx() * std::tan(std::fabs(at) + half);
    return std::fabs(at) + half < 0.5 * std::numbers::pi && most <= 0.5 * (size_px - 1.0) - edge_px;
  };
  for (int i = 0; i < outline.num_points; ++i) {
    const Vec3 p = X_CO * outline.p_OP[static_cast<std::size_t>(i)];
    if (!inside(p.x(), p.z(), kWidthPx) || !inside(p.y(), p.z(), kHeightPx)) {
      return false;
    }
  }
  return true;
}

bool StartChecks::TargetAboveTable(const Pose& X_BO) const {
  const features::TargetOutline outline = feature_.Outline();
  for (int i = 0; i < outline.num_points; ++i) {
    if ((X_BO * outline.p_OP[static_cast<std::size_t>(i)]).z() < outline.radius) {
      return false;
    }
  }
  return true;
}

// The arm as thick segments from joint to joint. Keeps apart: hand and links up to the elbow; target and
// whole arm; lines of sight and all links except the wrist, where the camera sits.
bool StartChecks::ArmInTheWay(const StartPosture& posture, const Pose& X_BO, const Clear& clear) const {
  const features::TargetOutline outline = feature_.Outline();
  std::vector<Vec3> line{Vec3::Zero()};
  for (int i = 0; i < arm_.num_joints; ++i) {
    line.push_back(posture.poses.X_BL[static_cast<std::size_t>(i)].p);
    if (i == 3) {
      line.push_back(ForearmStart(posture));
    }
  }
  line.push_back(posture.poses.X_BE.p);
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    if (DistanceToSegment(X_BO.p, line[i], line[i + 1]) < clear.target) {
      return true;
    }
    const bool upper = static_cast<int>(i) < kUpperLinks;
    for (int k = 0; upper && k < outline.num_points; ++k) {
      const Vec3 p_BP = X_BO * outline.p_OP[static_cast<std::size_t>(k)];
      if (DistanceOfSegments(posture.X_BC.p, p_BP, line[i], line[i + 1]) < clear.sight) {
        return true;
      }
    }
    const bool trunk = static_cast<int>(i) < kTrunkLinks;
    if (trunk && DistanceOfSegments(line[line.size() - 2], line.back(), line[i], line[i + 1]) < clear.trunk) {
      return true;
    }
  }
  return false;
}

bool StartChecks::BenchInTheWay(const StartPosture& posture, const Pose& X_BO) const {
  const features::TargetOutline outline = feature_.Outline();
  for (int k = 0; k < outline.num_points; ++k) {
    const Vec3 p_BP = X_BO * outline.p_OP[static_cast<std::size_t>(k)];
    if (ThingInTheWay(posture.X_BC.p, p_BP, kThingClear + outline.radius)) {
      return true;
    }
  }
  return false;
}

bool StartChecks::AboveTable(const StartPosture& posture) const { return AboveTable(posture, kAboveTable); }

bool StartChecks::InPicture(const Pose& X_CO) const { return InPicture(X_CO, kEdgePx); }

bool StartChecks::ArmInTheWay(const StartPosture& posture, const Pose& X_BO) const {
  return ArmInTheWay(posture, X_BO, kAtEnds);
}

bool StartChecks::OnTheWay(const StartPosture& posture, const Pose& X_BO) const {
  const Pose X_CO = posture.X_BC.Inverse() * X_BO;
  const bool faces = !feature_.SeesOrientation() || X_CO.R.col(2).dot(X_CO.p) > kSteepest * X_CO.p.norm();
  return X_CO.p.z() > kDepthOnTheWay && faces && InPicture(X_CO, kEdgeOnTheWayPx) && InsideBarrier(posture) &&
         AboveTable(posture, kAboveTableOnTheWay) && !ArmInTheWay(posture, X_BO, kOnTheWay) &&
         !BenchInTheWay(posture, X_BO);
}

bool StartChecks::OutOfViewOnTheWay(const Pose& X_CO) const {
  return X_CO.p.z() > kDepthOnTheWay && !InPicture(X_CO, kEdgeOnTheWayPx);
}

}  // namespace fovea::atlas
