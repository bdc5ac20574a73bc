// SPDX-License-Identifier: Apache-2.0
#include "tools/fovea/features/study.hpp"

#include <fmt/format.h>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "firmware/core/features/hold_orientation.hpp"

namespace fovea {
namespace {

using Twist = Eigen::Matrix<double, 6, 1>;
using model::Vec3;

constexpr double kZero = 1e-9;      // a singular value below this share of the largest is 0
constexpr double kParallel = 1e-6;  // a named twist this close to the free space is free

struct NamedTwist {
  std::string words;
  Twist V;
};

// A turn about the axis along `w` through `p_C`. Points on the axis keep their place in the picture.
Twist TurnAbout(const Vec3& p_C, const Vec3& w) {
  Twist V;
  V << model::Cross(p_C, w), w;
  return V.normalized();
}

Twist Shift(const Vec3& v) {
  Twist V = Twist::Zero();
  V.head<3>() = v.normalized();
  return V;
}

// Motions of the camera with a common name, the simplest first.
std::vector<NamedTwist> NamedTwists(const features::TargetFeature& feature, const model::Pose& X_CO) {
  const Vec3& p = X_CO.p;
  std::vector<NamedTwist> named{
      {"turn about the line of sight", TurnAbout(p, p)},
      {"swing around the target's centre, about the camera's x", TurnAbout(p, Vec3::UnitX())},
      {"swing around the target's centre, about the camera's y", TurnAbout(p, Vec3::UnitY())},
      {"turn about the camera's own axis", TurnAbout(Vec3::Zero(), Vec3::UnitZ())},
      {"turn about the camera's own x", TurnAbout(Vec3::Zero(), Vec3::UnitX())},
      {"turn about the camera's own y", TurnAbout(Vec3::Zero(), Vec3::UnitY())},
      {"shift along x", Shift(Vec3::UnitX())},
      {"shift along y", Shift(Vec3::UnitY())},
      {"shift along the camera's axis", Shift(Vec3::UnitZ())},
      {"shift along the line of sight", Shift(p)},
  };
  if (feature.SeesOrientation()) {
    const Vec3 a = X_CO * feature.corners.corners[0];
    const Vec3 b = X_CO * feature.corners.corners[1];
    named.push_back({"turn about the target's normal", TurnAbout(p, X_CO.R.col(2))});
    named.push_back({"tilt about the target's x through its centre", TurnAbout(p, X_CO.R.col(0))});
    named.push_back({"tilt about the target's y through its centre", TurnAbout(p, X_CO.R.col(1))});
    named.push_back({"tilt about the first side", TurnAbout(a, b - a)});
  }
  return named;
}

// Length of the part of V outside the span of `basis`, whose columns are orthonormal.
double Outside(const Eigen::MatrixXd& basis, const Twist& V) {
  return basis.cols() == 0 ? V.norm() : (V - basis * (basis.transpose() * V)).norm();
}

std::vector<FreeTwist> Describe(const Eigen::MatrixXd& null_space, const std::vector<NamedTwist>& named) {
  std::vector<FreeTwist> free;
  Eigen::MatrixXd covered(6, 0);
  const auto cover = [&](const Twist& V) {
    const Twist rest = covered.cols() == 0 ? V : Twist(V - covered * (covered.transpose() * V));
    covered.conservativeResize(6, covered.cols() + 1);
    covered.rightCols(1) = rest.normalized();
  };
  for (const NamedTwist& candidate : named) {
    if (covered.cols() < null_space.cols() && Outside(null_space, candidate.V) < kParallel &&
        Outside(covered, candidate.V) > 1e-3) {
      free.push_back({candidate.V, candidate.words});
      cover(candidate.V);
    }
  }
  for (Eigen::Index k = 0; k < null_space.cols() && covered.cols() < null_space.cols(); ++k) {
    const Twist V = null_space.col(k);
    if (Outside(covered, V) < 1e-3) {
      continue;
    }
    cover(V);
    const Twist rest = covered.rightCols(1);
    free.push_back(
        {rest, fmt::format("a combined motion: v = ({:.3f}, {:.3f}, {:.3f}) m/s with w = ({:.3f}, {:.3f}, "
                           "{:.3f}) rad/s",
                           rest[0], rest[1], rest[2], rest[3], rest[4], rest[5])});
  }
  return free;
}

// The shifts and the turns about the target that are part of no free motion.
std::vector<std::string> Controlled(const Eigen::MatrixXd& null_space, const Vec3& p) {
  Eigen::Matrix<double, 6, 6> basis;  // columns: shifts, then turns about the target's centre
  const Vec3 sight = p.normalized();
  const Vec3 across = model::Cross(Vec3::UnitY(), sight).normalized();
  const Vec3 turns[] = {across, model::Cross(sight, across), sight};
  for (int i = 0; i < 3; ++i) {
    basis.col(i) = Shift(Vec3::Unit(i));
    basis.col(3 + i) << model::Cross(p, turns[i]), turns[i];
  }
  const char* const names[] = {"x", "y", "z", "tilt about x", "tilt about y", "turn about the line of sight"};
  if (null_space.cols() == 0) {
    return {std::begin(names), std::end(names)};
  }
  const Eigen::MatrixXd shares = basis.partialPivLu().solve(null_space);
  std::vector<std::string> controlled;
  for (int i = 0; i < 6; ++i) {
    if (shares.row(i).norm() < kParallel) {
      controlled.emplace_back(names[i]);
    }
  }
  return controlled;
}

}  // namespace

FeatureStudy Study(const features::TargetFeature& feature, const model::Pose& X_CO) {
  FeatureStudy study;
  if (!feature.Compute({X_CO, Vec3::Zero(), Vec3::Zero()}, study.state)) {
    study.refused = true;
    return study;
  }
  if (feature.hold_orientation) {
    features::FeatureState held;
    if (!features::HoldOrientation{}.Compute(model::Mat3::Identity(), held) ||
        !features::Stack(held, study.state)) {
      study.refused = true;
      return study;
    }
  }
  const Eigen::MatrixXd L_s = study.state.L_s;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(L_s, Eigen::ComputeFullV);
  const Eigen::VectorXd& sigma = svd.singularValues();
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    study.sigma.push_back(sigma[i]);
    study.rank += sigma[i] > kZero * sigma[0] ? 1 : 0;
  }
  const bool full = study.rank == static_cast<int>(sigma.size());
  study.condition = full ? sigma[0] / sigma[sigma.size() - 1] : std::numeric_limits<double>::infinity();
  const Eigen::MatrixXd null_space = svd.matrixV().rightCols(6 - study.rank);
  study.free = Describe(null_space, NamedTwists(feature, X_CO));
  study.controls = Controlled(null_space, X_CO.p);
  return study;
}

model::Pose LookFrom(const Vec3& p_OC) {
  const Vec3 z = -p_OC.normalized();
  const Vec3 aside = std::fabs(z.y()) < 0.99 ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 x = model::Cross(aside, z).normalized();
  model::Pose X_OC;
  X_OC.R << x, model::Cross(z, x), z;
  X_OC.p = p_OC;
  return X_OC.Inverse();
}

std::string Parameters(const features::TargetFeature& feature) {
  const std::string held = feature.hold_orientation ? ", turn held (3)" : "";
  const std::string turn = feature.SeesOrientation() ? ", turn (3)" : "";
  switch (feature.form) {
    case features::FeatureForm::kSphere: return "X/R, Y/R, Z/R" + held;
    case features::FeatureForm::kCircle: return "x, y, D/Z" + held;
    case features::FeatureForm::kCorners:
      return fmt::format("x, y of {} corners{}", feature.corners.num_corners, held);
    case features::FeatureForm::kSide: return "x, y of the centre, angle, side" + held;
    case features::FeatureForm::kCornerSide: return "x, y of a corner, angle, side" + held;
    case features::FeatureForm::kPose: return "X, Y, Z" + turn + held;
    case features::FeatureForm::kHybrid: return "x, y, ln Z" + turn + held;
  }
  return "";
}

std::string ConditionText(double condition) {
  return std::isfinite(condition) ? fmt::format("{:.4g}", condition) : std::string("infinite");
}

}  // namespace fovea
