// SPDX-License-Identifier: Apache-2.0
#include "firmware/vision/pose/flat_pose.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "firmware/core/model/rotation.hpp"
#include "firmware/vision/pose/three_points.hpp"

namespace fovea::vision {
namespace {

using model::Mat3;
using model::Vec3;

constexpr double kMostTilt = 80.0 * std::numbers::pi / 180.0;  // largest tilt against the line of sight
constexpr double kNoChance = 30.0;  // a pose whose chi^2 exceeds the least one by this is rejected
constexpr double kByChance = 3.0;   // chi^2 per degree of freedom that noise alone may reach
constexpr double kSameTurn = 0.01;  // poses nearer to each other than this are one [rad]
// Damping of the Gauss-Newton steps: no large steps in directions that the corners do not determine.
constexpr double kStepM = 0.1;
constexpr double kStepRad = 0.05;

// 0 for a pose that faces the camera squarely and upright; the turn about the view axis only breaks ties.
double Unlikeness(const Mat3& R) {
  const double tilt = std::acos(std::clamp(R(2, 2), -1.0, 1.0));
  const double turn = std::atan2(R(1, 0), R(0, 0));
  return tilt + 0.02 * std::fabs(turn);
}

double AngleBetween(const Mat3& a, const Mat3& b) {
  return std::acos(std::clamp(0.5 * ((a.transpose() * b).trace() - 1.0), -1.0, 1.0));
}

struct Refined {
  CornerPose pose;
  double chi2 = 0.0;
  bool ok = false;
};

// Gauss-Newton on the corners, weighted by their covariance. `at[i]` is the image corner of O's corner i.
Refined Refine(const CornerFit& fit, const std::array<int, Detection::kMaxCorners>& at, const Intrinsics& in,
               FlatShape shape, const model::Pose& start) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, CornerFit::kMaxSize, 6>;
  using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, CornerFit::kMaxSize>;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, CornerFit::kMaxSize, 1>;
  const int n = fit.count;
  Refined r;
  model::Pose& X_CO = r.pose.X_CO;
  X_CO = start;
  r.pose.first = at[0];
  CornerFit::Covariance cov(2 * n, 2 * n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      cov.block<2, 2>(2 * i, 2 * j) =
          fit.cov.block<2, 2>(2 * at[static_cast<std::size_t>(i)], 2 * at[static_cast<std::size_t>(j)]);
    }
  }
  const CornerFit::Covariance info = cov.inverse();
  Vector e(2 * n);
  Rows J(2 * n, 6);
  constexpr int kRounds = 30;        // if the corners hardly determine the tilt; else four or five
  constexpr double kStill2 = 1e-20;  // a smaller step is the last [m^2 + rad^2]
  bool still = false;
  for (int round = 0; round <= kRounds; ++round) {
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector2d& q = shape[static_cast<std::size_t>(i)];
      const Vec3 arm = X_CO.R * Vec3(q.x(), q.y(), 0.0);
      const Vec3 p = X_CO.p + arm;
      if (!(p.z() > 1e-3)) {
        return r;
      }
      const ImagePoint& c = fit.corner[static_cast<std::size_t>(at[static_cast<std::size_t>(i)])];
      e[2 * i] = c.u_px - in.U(p);
      e[2 * i + 1] = c.v_px - in.V(p);
      Eigen::Matrix<double, 2, 3> project;
      project << in.f_u_px / p.z(), 0.0, -in.f_u_px * p.x() / (p.z() * p.z()), 0.0, in.f_v_px / p.z(),
          -in.f_v_px * p.y() / (p.z() * p.z());
      J.block<2, 3>(2 * i, 0) = project;
      J.block<2, 3>(2 * i, 3) = -project * model::CrossMatrix(arm);
    }
    const Columns weighted = J.transpose().lazyProduct(info);
    model::Mat6 normal = weighted.lazyProduct(J);
    normal.diagonal().head<3>().array() += 1.0 / (kStepM * kStepM);
    normal.diagonal().tail<3>().array() += 1.0 / (kStepRad * kStepRad);
    if (still || round == kRounds) {
      r.chi2 = e.dot(info.lazyProduct(e));
      r.pose.misfit = n > 3 ? std::max(1.0, r.chi2 / (kByChance * (2 * n - 6))) : 1.0;
      r.pose.cov = normal.inverse() * std::max(1.0, n > 3 ? r.chi2 / (2 * n - 6) : 1.0);
      break;
    }
    const model::Vec6 step = normal.ldlt().solve(weighted.lazyProduct(e));
    if (!step.allFinite()) {
      return r;
    }
    X_CO.p += step.head<3>();
    X_CO.R = model::RotationOf(step.tail<3>()) * X_CO.R;
    still = step.squaredNorm() < kStill2;
  }
  r.pose.off_px = std::sqrt(e.squaredNorm() / n);
  // True when the painted side faces the camera and the viewing angle is not too flat.
  r.ok = r.pose.cov.allFinite() && X_CO.p.z() > 0.0 &&
         X_CO.R.col(2).dot(X_CO.p) > std::cos(kMostTilt) * X_CO.p.norm();
  return r;
}

// The different poses found so far.
struct Found {
  static constexpr int kMost = 24;
  int count = 0;
  std::array<Refined, kMost> poses;

  [[nodiscard]] bool Has(const Refined& r) const {
    return std::any_of(poses.begin(), poses.begin() + count, [&r](const Refined& other) {
      return other.pose.first == r.pose.first && AngleBetween(other.pose.X_CO.R, r.pose.X_CO.R) < kSameTurn;
    });
  }
  void Add(const Refined& r) {
    if (r.ok && count < kMost && !Has(r)) {
      poses[static_cast<std::size_t>(count++)] = r;
    }
  }
};

// The same pose, tilted to the opposite side of the line of sight.
model::Pose Mirrored(const model::Pose& X_CO) {
  const Vec3 sight = X_CO.p.normalized();
  const Vec3 normal = X_CO.R.col(2);
  const Vec3 axis = normal.cross(sight);
  const double sine = axis.norm();
  if (!(sine > 1e-9)) {
    return X_CO;
  }
  const double tilt = std::atan2(sine, normal.dot(sight));
  return {model::RotationOf(2.0 * tilt / sine * axis) * X_CO.R, X_CO.p};
}

// Adds all poses with image corner `first` as O's corner 0: starts from three corners, then refines with all.
void FindPoses(const CornerFit& fit, const Intrinsics& in, FlatShape shape, const model::Pose* last,
               int first, Found& found) {
  std::array<int, Detection::kMaxCorners> at{};
  for (int i = 0; i < fit.count; ++i) {
    at[static_cast<std::size_t>(i)] = (first + i) % fit.count;
  }
  std::array<Vec3, 3> object;
  std::array<Vec3, 3> rays;
  for (std::size_t i = 0; i < object.size(); ++i) {
    object[i] = Vec3(shape[i].x(), shape[i].y(), 0.0);
    const ImagePoint& c = fit.corner[static_cast<std::size_t>(at[i])];
    rays[i] = in.Ray(c.u_px, c.v_px).normalized();
  }
  const int begin = found.count;
  const ThreePointPoses starts = PosesOfThreePoints(object, rays);
  for (int i = 0; i < starts.count; ++i) {
    found.Add(Refine(fit, at, in, shape, starts.X_CO[static_cast<std::size_t>(i)]));
  }
  if (last != nullptr) {
    found.Add(Refine(fit, at, in, shape, *last));
  }
  // Four corners have a second pose near the first's mirror image about the line of sight.
  for (int i = begin, count = fit.count == 4 ? found.count : 0; i < count; ++i) {
    found.Add(Refine(fit, at, in, shape, Mirrored(found.poses[static_cast<std::size_t>(i)].pose.X_CO)));
  }
}

// A target with `count` corners looks the same after each equal turn: chooses the turn with the least cost.
template <class Cost>
void ChooseTurn(const Cost& cost, int count, int turns, CornerPose& pose) {
  const CornerPose found = pose;
  double best = cost(pose.X_CO.R);
  for (int turn = 1; turn < turns; ++turn) {
    const Mat3 R = found.X_CO.R * model::RotationOf(Vec3(0.0, 0.0, 2.0 * std::numbers::pi * turn / turns));
    if (cost(R) < best) {
      best = cost(R);
      pose.X_CO.R = R;
      pose.first = (found.first + turn * count / turns) % count;
    }
  }
}

}  // namespace

bool PosesOfDisc(const Eigen::Matrix3d& conic, const Intrinsics& in, double diameter, double round_below,
                 std::array<DiscPose, 2>& poses) {
  Mat3 K;
  K << in.f_u_px, 0.0, in.c_u_px, 0.0, in.f_v_px, in.c_v_px, 0.0, 0.0, 1.0;
  const Mat3 Q = K.transpose() * conic * K;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(Q / Q.norm());
  // One negative eigenvalue, along the cone's axis, and two positive ones.
  Vec3 axis = eigen.eigenvectors().col(0);
  const double l3 = eigen.eigenvalues()[0];
  double l2 = eigen.eigenvalues()[1];  // along the longer half axis
  double l1 = eigen.eigenvalues()[2];  // along the shorter
  if (!(l3 < 0.0) || !(l2 > 0.0)) {
    return false;
  }
  if (axis.z() < 0.0) {
    axis = -axis;
  }
  const Vec3 e1 = eigen.eigenvectors().col(2);
  // Noise makes an outline look longer, never rounder: subtract its mean square.
  const double mean = 0.5 * (l1 + l2);
  const double half = 0.5 * (l1 - l2);
  const double noise = round_below * mean;
  const double true_half = std::sqrt(std::max(0.0, half * half - noise * noise));
  l1 = mean + true_half;
  l2 = mean - true_half;
  // The plane that cuts the cone x' Q x = 0 in a circle (Q = l1 e1 e1' + l2 e2 e2' + l3 a a').
  const double sine = std::sqrt(std::max(0.0, (l1 - l2) / (l1 - l3)));
  const double cosine = std::sqrt((l2 - l3) / (l1 - l3));
  const double distance = 0.5 * diameter * l2 / std::sqrt(-l1 * l3);  // of the plane from the camera
  for (int i = 0; i < 2; ++i) {
    const double s = i == 0 ? sine : -sine;
    DiscPose& pose = poses[static_cast<std::size_t>(i)];
    pose.normal_C = cosine * axis + s * e1;
    // The circle's centre: x = distance n + t across meets the cone x' Q x = 0 at two t; take their mean.
    const Vec3 across = -s * axis + cosine * e1;
    const double t = -distance * (l1 - l3) * s * cosine / l2;
    pose.p_CO_C = distance * pose.normal_C + t * across;
    if (!(pose.p_CO_C.z() > 0.0) || !pose.p_CO_C.allFinite()) {
      return false;
    }
  }
  return true;
}

CornerPoses PosesOfCorners(const CornerFit& fit, const Intrinsics& in, FlatShape shape, int turns,
                           const model::Pose* last) {
  CornerPoses poses;
  const int n = fit.count;
  if (n != static_cast<int>(shape.size())) {
    return poses;
  }
  Found found;
  for (int first = 0; first < n / turns; ++first) {
    FindPoses(fit, in, shape, last, first, found);
  }
  const auto all = std::span(found.poses).first(static_cast<std::size_t>(found.count));
  double least = 1e9;
  for (const Refined& r : all) {
    least = std::min(least, r.chi2);
  }
  const auto cost = [last](const Mat3& R) {
    return last != nullptr ? AngleBetween(last->R, R) : Unlikeness(R);
  };
  for (Refined& r : all) {
    ChooseTurn(cost, n, turns, r.pose);
  }
  std::sort(all.begin(), all.end(),
            [&](const Refined& a, const Refined& b) { return cost(a.pose.X_CO.R) < cost(b.pose.X_CO.R); });
  for (const Refined& r : all) {
    if (r.chi2 - least <= kNoChance * std::max(1.0, 0.5 * least) && poses.count < hal::kMaxPoses) {
      poses.pose[static_cast<std::size_t>(poses.count++)] = r.pose;
    }
  }
  return poses;
}

}  // namespace fovea::vision
