#include "atlas_sampler.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "atlas_bench.hpp"
#include "atlas_way.hpp"
#include "fovea/model/rotation.hpp"

namespace fovea::atlas {
namespace {

using model::Mat3;
using model::Pose;
using model::Vec3;
using model::VecN;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
// The picture of the scenario `ball`.
constexpr double kWidthPx = 640.0;
constexpr double kHeightPx = 480.0;
constexpr double kHfovDeg = 60.0;
constexpr double kEdgePx = 30.0;
constexpr double kDepthLeast = 0.25;  // [m]
constexpr double kDepthMost = 0.90;
constexpr double kTiltMostDeg = 45.0;
constexpr double kJointMargin = 5.0 * kRadPerDeg;
constexpr double kRadius = 0.845;      // 1 mm inside what the servo keeps of safety.workspace_radius [m]
constexpr double kAboveTable = 0.10;   // [m]
constexpr double kArmRadius = 0.10;    // about the line through the joints [m]
constexpr double kTargetClear = 0.15;  // of that line [m]
constexpr double kThingClear = 0.01;   // of the lines of sight, and of the target [m]
// And along a way, what the servo itself keeps.
constexpr double kEdgeOnTheWayPx = 10.0;
constexpr double kAboveTableOnTheWay = 0.09;  // [m]
constexpr double kDepthOnTheWay = 0.05;       // [m]
constexpr double kSteepest = 0.2;             // cosine between a flat target's normal and the line of sight
constexpr double kRangeOnTheWay = 0.06;       // more of each joint's range, at either end [rad]
constexpr int kUpperLinks = 6;                // lines up to the forearm's, which the sight must pass by,
constexpr int kTrunkLinks = 3;                // and up to the elbow, which the hand must
constexpr int kMostDraws = 1'000'000;
constexpr double kNear = 0.5;      // [rad]
constexpr int kNearDescents = 16;  // from about the start, and from anywhere
constexpr int kFarDescents = 24;
constexpr int kDescentSteps = 120;

double FocalPx() { return 0.5 * kWidthPx / std::tan(0.5 * kHfovDeg * kRadPerDeg); }
double U(const Vec3& p_C) { return 0.5 * (kWidthPx - 1.0) + FocalPx() * p_C.x() / p_C.z(); }
double V(const Vec3& p_C) { return 0.5 * (kHeightPx - 1.0) + FocalPx() * p_C.y() / p_C.z(); }

double Uniform(std::mt19937_64& engine, double low, double high) {
  return low + (high - low) * static_cast<double>(engine() >> 11U) * 0x1p-53;
}

double Rounded(double value, double step) { return std::round(value / step) * step; }

double DistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - a - t * ab).norm();
}

// Of points along it, which is near enough for something as thick as an arm.
double DistanceOfSegments(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  constexpr int kPoints = 20;
  double least = DistanceToSegment(a, c, d);
  for (int i = 1; i <= kPoints; ++i) {
    least = std::min(least, DistanceToSegment(a + (b - a) * i / kPoints, c, d));
  }
  return least;
}

// Roll, pitch, yaw about fixed axes, as a scenario writes an orientation.
std::array<double, 3> RollPitchYawDeg(const Mat3& R) {
  return {std::atan2(R(2, 1), R(2, 2)) / kRadPerDeg,
          std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))) / kRadPerDeg,
          std::atan2(R(1, 0), R(0, 0)) / kRadPerDeg};
}

Mat3 RotationOfRpyDeg(const std::array<double, 3>& rpy_deg) {
  return model::RotationOf({0.0, 0.0, rpy_deg[2] * kRadPerDeg}) *
         model::RotationOf({0.0, rpy_deg[1] * kRadPerDeg, 0.0}) *
         model::RotationOf({rpy_deg[0] * kRadPerDeg, 0.0, 0.0});
}

}  // namespace

const Sampler::Clear Sampler::kAtEnds{kArmRadius, kTargetClear, kTargetClear};
const Sampler::Clear Sampler::kOnTheWay{0.08, 0.10, 0.13};

Sampler::Sampler(const model::ArmModel& arm, const features::TargetFeature& feature)
    : arm_(arm), feature_(feature) {
  X_EC_.R = model::RotationOf({0.0, 0.0, 0.5 * std::numbers::pi});
  X_EC_.p = {0.05, 0.0, 0.04};
  q_least_.resize(arm_.num_joints);
  q_most_.resize(arm_.num_joints);
  for (int i = 0; i < arm_.num_joints; ++i) {
    const model::Joint& joint = arm_.joints[static_cast<std::size_t>(i)];
    q_least_[i] = joint.q_min + kJointMargin;
    q_most_[i] = joint.q_max - kJointMargin;
  }
}

Sampler::Posture Sampler::At(const VecN& q) const {
  Posture posture;
  posture.q = q;
  model::ComputePoses(arm_, q, posture.poses);
  posture.X_BC = posture.poses.X_BE * X_EC_;
  return posture;
}

VecN Sampler::DrawPosture(std::mt19937_64& engine) const {
  constexpr double kStep = 1e-4;
  VecN q(arm_.num_joints);
  for (int i = 0; i < q.size(); ++i) {
    q[i] = Rounded(Uniform(engine, q_least_[i] + kStep, q_most_[i] - kStep), kStep);
  }
  return q;
}

// X_CO of a target somewhere in the picture.
Pose Sampler::DrawTarget(std::mt19937_64& engine) const {
  const double u = Uniform(engine, 0.0, kWidthPx - 1.0);
  const double v = Uniform(engine, 0.0, kHeightPx - 1.0);
  const double depth = Uniform(engine, kDepthLeast, kDepthMost);
  const double tilt = kRadPerDeg * Uniform(engine, 0.0, kTiltMostDeg);
  const double about = Uniform(engine, -std::numbers::pi, std::numbers::pi);
  const double turn = Uniform(engine, -std::numbers::pi, std::numbers::pi);
  Pose X_CO;
  X_CO.p =
      depth * Vec3((u - 0.5 * (kWidthPx - 1.0)) / FocalPx(), (v - 0.5 * (kHeightPx - 1.0)) / FocalPx(), 1.0);
  X_CO.R = model::RotationOf({tilt * std::cos(about), tilt * std::sin(about), 0.0}) *
           model::RotationOf({0.0, 0.0, turn});
  return X_CO;
}

bool Sampler::InsideBarrier(const Posture& posture) const { return posture.poses.X_BE.p.norm() <= kRadius; }

// Where the forearm's axis begins, beside the elbow joint (a_5 of the Panda's table).
Vec3 Sampler::ForearmStart(const Posture& posture) const {
  const Pose& X_BL4 = posture.poses.X_BL[3];
  return X_BL4 * Vec3(arm_.joints[4].X_PJ.p.x(), 0.0, 0.0);
}

bool Sampler::AboveTable(const Posture& posture, double height) const {
  double lowest = std::min({posture.poses.X_BE.p.z(), posture.X_BC.p.z(), ForearmStart(posture).z()});
  for (int i = 3; i < arm_.num_joints; ++i) {  // what comes before stands on the table
    lowest = std::min(lowest, posture.poses.X_BL[static_cast<std::size_t>(i)].p.z());
  }
  return lowest >= height;
}

// A ball's outline along one axis of the picture lies between the tangents to it (exact, off axis too).
bool Sampler::InPicture(const Pose& X_CO, double edge_px) const {
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

bool Sampler::TargetAboveTable(const Pose& X_BO) const {
  const features::TargetOutline outline = feature_.Outline();
  for (int i = 0; i < outline.num_points; ++i) {
    if ((X_BO * outline.p_OP[static_cast<std::size_t>(i)]).z() < outline.radius) {
      return false;
    }
  }
  return true;
}

// The arm as a thick line from joint to joint: what hangs on the wrist keeps clear of what comes before, the
// target of all of it, and the lines of sight of all but the wrist, where the camera sits.
bool Sampler::ArmInTheWay(const Posture& posture, const Pose& X_BO, const Clear& clear) const {
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

bool Sampler::BenchInTheWay(const Posture& posture, const Pose& X_BO) const {
  const features::TargetOutline outline = feature_.Outline();
  for (int k = 0; k < outline.num_points; ++k) {
    const Vec3 p_BP = X_BO * outline.p_OP[static_cast<std::size_t>(k)];
    if (ThingInTheWay(posture.X_BC.p, p_BP, kThingClear + outline.radius)) {
      return true;
    }
  }
  return false;
}

// The goal's orientation; of a square the one of four that is nearest.
Mat3 Sampler::NearestGoal(const Mat3& R_CO) const {
  const int turns = feature_.target == hal::FeatureKind::kSquare ? 4 : 1;
  Mat3 nearest = feature_.R_CO_star;
  for (int turn = 1; turn < turns; ++turn) {
    const Mat3 other = feature_.R_CO_star * model::RotationOf({0.0, 0.0, 0.5 * std::numbers::pi * turn});
    if ((other.transpose() * R_CO).trace() > (nearest.transpose() * R_CO).trace()) {
      nearest = other;
    }
  }
  return nearest;
}

// Gauss-Newton on the target's pose in the camera: with V the camera's twist, dp_CO/dt = -v + [p]x w and the
// orientation turns by -w. A joint at its end rests where the step would take it further.
std::optional<VecN> Sampler::DescentTo(const VecN& q_start, const Pose& X_BO) const {
  constexpr double kStepMost = 0.2;  // [rad]
  constexpr double kDamping = 1e-6;
  constexpr double kReached = 1e-5;  // [m, rad]
  const int rows = feature_.SeesOrientation() ? 6 : 3;
  VecN q = q_start;
  for (int step = 0; step < kDescentSteps; ++step) {
    const Posture posture = At(q);
    const Pose X_CO = posture.X_BC.Inverse() * X_BO;
    model::Vec6 off = model::Vec6::Zero();
    off.head<3>() = X_CO.p - feature_.p_CO_C_star;
    if (rows == 6) {
      off.tail<3>() = model::RotationVector(X_CO.R * NearestGoal(X_CO.R).transpose());
    }
    if (off.norm() < kReached) {
      const bool stands = InsideBarrier(posture) && AboveTable(posture, kAboveTable) &&
                          !ArmInTheWay(posture, X_BO, kAtEnds) && !BenchInTheWay(posture, X_BO);
      return stands ? std::optional<VecN>(q) : std::nullopt;
    }
    model::Mat6N J_C;
    model::ComputeJacobian(arm_, posture.poses, X_EC_, J_C);
    model::Mat6N J(6, arm_.num_joints);
    J.topRows<3>() = -J_C.topRows<3>() + model::CrossMatrix(X_CO.p) * J_C.bottomRows<3>();
    J.bottomRows<3>() = -J_C.bottomRows<3>();
    Eigen::MatrixXd A = J.topRows(rows);
    Eigen::VectorXd dq = Eigen::VectorXd::Zero(q.size());
    for (int pass = 0; pass <= q.size(); ++pass) {
      Eigen::MatrixXd AAt = A * A.transpose();
      AAt.diagonal().array() += kDamping;
      dq = -A.transpose() * AAt.ldlt().solve(Eigen::VectorXd(off.head(rows)));
      const double largest = dq.cwiseAbs().maxCoeff();
      dq *= largest > kStepMost ? kStepMost / largest : 1.0;
      bool held = false;
      for (int i = 0; i < q.size(); ++i) {
        const bool at_end = (q[i] >= q_most_[i] && dq[i] > 0.0) || (q[i] <= q_least_[i] && dq[i] < 0.0);
        if (at_end) {
          A.col(i).setZero();
          held = true;
        }
      }
      if (!held) {
        break;
      }
    }
    q = (q + dq).cwiseMax(q_least_).cwiseMin(q_most_);
  }
  return std::nullopt;
}

// What holds along a way: somewhat less than at its ends.
bool Sampler::OnTheWay(const VecN& q, const Pose& X_BO) const {
  const Posture posture = At(q);
  const Pose X_CO = posture.X_BC.Inverse() * X_BO;
  const bool faces = !feature_.SeesOrientation() || X_CO.R.col(2).dot(X_CO.p) > kSteepest * X_CO.p.norm();
  return X_CO.p.z() > kDepthOnTheWay && faces && InPicture(X_CO, kEdgeOnTheWayPx) && InsideBarrier(posture) &&
         AboveTable(posture, kAboveTableOnTheWay) && !ArmInTheWay(posture, X_BO, kOnTheWay) &&
         !BenchInTheWay(posture, X_BO);
}

// A step of Gauss-Newton that takes the target's centre a third of the way to the picture's, when the target
// is not wholly in it.
VecN Sampler::PulledIntoView(const VecN& q, const Pose& X_BO) const {
  constexpr double kShare = 1.0 / 3.0;
  const Posture posture = At(q);
  const Pose X_CO = posture.X_BC.Inverse() * X_BO;
  if (!(X_CO.p.z() > kDepthOnTheWay) || InPicture(X_CO, kEdgeOnTheWayPx)) {
    return q;
  }
  model::Mat6N J_C;
  model::ComputeJacobian(arm_, posture.poses, X_EC_, J_C);
  const Eigen::MatrixXd dp = -J_C.topRows<3>() + model::CrossMatrix(X_CO.p) * J_C.bottomRows<3>();
  const double x = X_CO.p.x() / X_CO.p.z();
  const double y = X_CO.p.y() / X_CO.p.z();
  Eigen::MatrixXd A(2, q.size());
  A.row(0) = (dp.row(0) - x * dp.row(2)) / X_CO.p.z();
  A.row(1) = (dp.row(1) - y * dp.row(2)) / X_CO.p.z();
  return q - A.transpose() * (A * A.transpose()).ldlt().solve(kShare * Eigen::Vector2d(x, y));
}

bool Sampler::WayLeadsOn(const VecN& q, const Pose& X_BO, std::uint64_t seed) const {
  std::mt19937_64 engine(seed);
  std::vector<VecN> goals;
  const auto descend = [&](const VecN& from) {
    if (const std::optional<VecN> goal = DescentTo(from, X_BO)) {
      goals.push_back(*goal);
    }
  };
  descend(q);
  for (int i = 0; i < kNearDescents; ++i) {
    const VecN near = q.unaryExpr([&](double joint) { return joint + Uniform(engine, -kNear, kNear); });
    descend(near.cwiseMax(q_least_).cwiseMin(q_most_));
  }
  for (int i = 0; i < kFarDescents; ++i) {
    descend(DrawPosture(engine));
  }
  WayProblem problem;
  problem.least = q_least_.array() - kRangeOnTheWay;
  problem.most = q_most_.array() + kRangeOnTheWay;
  problem.is_allowed = [&](const VecN& at) { return OnTheWay(at, X_BO); };
  problem.pull = [&](const VecN& at) { return PulledIntoView(at, X_BO); };
  return WayExists(problem, q, goals, engine());
}

Sampler::Goal Sampler::FindGoal(std::mt19937_64& engine, const VecN& q, const Pose& X_BO) const {
  bool found = DescentTo(q, X_BO).has_value();
  for (int i = 0; i < kNearDescents && !found; ++i) {
    const VecN near = q.unaryExpr([&](double joint) { return joint + Uniform(engine, -kNear, kNear); });
    found = DescentTo(near.cwiseMax(q_least_).cwiseMin(q_most_), X_BO).has_value();
  }
  if (found) {
    return Goal::kNear;
  }
  for (int i = 0; i < kFarDescents && !found; ++i) {
    found = DescentTo(DrawPosture(engine), X_BO).has_value();
  }
  return found ? Goal::kElsewhere : Goal::kNone;
}

double Sampler::ErrorPx(const Pose& X_CO) const {
  const bool turned = feature_.SeesOrientation();
  const Pose goal{turned ? NearestGoal(X_CO.R) : Mat3::Identity(), feature_.p_CO_C_star};
  const int points = turned ? feature_.corners.num_corners : 1;
  double sum2 = 0.0;
  for (int i = 0; i < points; ++i) {
    const Vec3 p_OP = turned ? feature_.corners.corners[static_cast<std::size_t>(i)] : Vec3(Vec3::Zero());
    const Vec3 p = X_CO * p_OP;
    const Vec3 p_star = goal * p_OP;
    sum2 += std::pow(U(p) - U(p_star), 2) + std::pow(V(p) - V(p_star), 2);
  }
  return std::sqrt(sum2 / points);
}

Start Sampler::Draw(std::uint64_t seed, int index) const {
  std::seed_seq mixed{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                      static_cast<std::uint32_t>(index)};
  std::mt19937_64 engine(mixed);
  Start start;
  const auto refuse = [&](Rejection reason) { ++start.rejections[static_cast<std::size_t>(reason)]; };
  for (int draw = 0; draw < kMostDraws; ++draw) {
    const Posture posture = At(DrawPosture(engine));
    const Pose drawn = DrawTarget(engine);
    if (!InsideBarrier(posture)) {
      refuse(Rejection::kStartOutsideBarrier);
      continue;
    }
    if (!AboveTable(posture, kAboveTable)) {
      refuse(Rejection::kStartBelowTable);
      continue;
    }
    // As the run will be told of it.
    Pose X_BO = posture.X_BC * drawn;
    X_BO.p = X_BO.p.unaryExpr([](double x) { return Rounded(x, 1e-4); });
    start.rpy_deg = RollPitchYawDeg(X_BO.R);
    for (double& angle : start.rpy_deg) {
      angle = Rounded(angle, 0.01);
    }
    X_BO.R = RotationOfRpyDeg(start.rpy_deg);
    const Pose X_CO = posture.X_BC.Inverse() * X_BO;
    if (!InPicture(X_CO, kEdgePx)) {
      refuse(Rejection::kTargetNearEdge);
      continue;
    }
    if (!TargetAboveTable(X_BO)) {
      refuse(Rejection::kTargetBelowTable);
      continue;
    }
    if (ArmInTheWay(posture, X_BO, kAtEnds)) {
      refuse(Rejection::kArmInTheWay);
      continue;
    }
    if (BenchInTheWay(posture, X_BO)) {
      refuse(Rejection::kThingInTheWay);
      continue;
    }
    const Goal goal = FindGoal(engine, posture.q, X_BO);
    if (goal != Goal::kNear) {
      refuse(goal == Goal::kNone ? Rejection::kNoGoalPosture : Rejection::kGoalElsewhere);
      continue;
    }
    // By numbers of its own, so that the next draws are what they were without it.
    if (!WayLeadsOn(posture.q, X_BO, seed + static_cast<std::uint64_t>(index))) {
      refuse(Rejection::kNoWay);
      continue;
    }
    start.q.assign(posture.q.begin(), posture.q.end());
    start.p_BO = X_BO.p;
    start.run_seed = static_cast<std::uint32_t>(engine() >> 33U);
    start.u_px = U(X_CO.p);
    start.v_px = V(X_CO.p);
    start.depth = X_CO.p.z();
    start.tilt_deg = std::acos(std::clamp(X_CO.R(2, 2), -1.0, 1.0)) / kRadPerDeg;
    start.error_px = ErrorPx(X_CO);
    return start;
  }
  throw std::runtime_error("no feasible start in a million draws");
}

}  // namespace fovea::atlas
