// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/stuck_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/core/estimate/corner_view.hpp"

namespace fovea::estimate {
namespace {

using features::SeenCorners;
using model::Vec3;

constexpr double kHalfPicture = 0.3;  // test points are this far from the target in the normalised image
constexpr double kInPicture = 1e-3;   // a point nearer to the camera's plane is out of the picture [m]
constexpr double kDepthShare =
    0.1;  // shift in the picture that a change of depth by its whole size counts as

// The largest shift in the picture of points at rest in B and at the target's depth, while the camera moved
// from `X_BC_then` to `X_BC`.
double ShiftOfScene(const model::Pose& X_BC_then, const model::Pose& X_BC, const Vec3& p_CO_C) noexcept {
  constexpr std::array<std::array<double, 2>, 5> kOff{
      {{0.0, 0.0}, {kHalfPicture, 0.0}, {-kHalfPicture, 0.0}, {0.0, kHalfPicture}, {0.0, -kHalfPicture}}};
  const model::Pose X_CnowCthen = X_BC.Inverse() * X_BC_then;
  double most = 0.0;
  for (const auto& off : kOff) {
    const Vec3 then = p_CO_C + p_CO_C.z() * Vec3(off[0], off[1], 0.0);
    const Vec3 now = X_CnowCthen * then;
    if (then.z() < kInPicture || now.z() < kInPicture) {
      return HUGE_VAL;  // it left the picture
    }
    most = std::max(most, (now.head<2>() / now.z() - then.head<2>() / then.z()).norm());
  }
  return most;
}

// The squared distance of a target's measured place from the expected one, in the picture. The depth counts
// little: it is measured much worse than the direction, and the poses that fit a triangle have different
// ones.
double Off2(const Vec3& measured, const Vec3& expected) noexcept {
  if (!(measured.z() >= kInPicture) || !(expected.z() >= kInPicture)) {
    return HUGE_VAL;
  }
  const double deeper = kDepthShare * (measured.z() / expected.z() - 1.0);
  return (measured.head<2>() / measured.z() - expected.head<2>() / expected.z()).squaredNorm() +
         deeper * deeper;
}

// The squared distance of the seen corners from the expected ones, a mean over them.
double Off2(const SeenCorners::Vector& seen, const SeenCorners::Vector& expected) noexcept {
  const auto n = static_cast<int>(seen.size() / 2);
  const int first = NearestFirst(seen, expected);
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    sum += (seen.segment<2>(2 * ((first + i) % n)) - expected.segment<2>(2 * i)).squaredNorm();
  }
  return sum / n;
}

// The corners `xy` at the depth `depth` [m], seen after the camera has moved. False if one left the picture.
bool SeeAgain(const SeenCorners::Vector& xy, double depth, const model::Pose& X_CnowCthen,
              SeenCorners::Vector& again) noexcept {
  again.resize(xy.size());
  for (Eigen::Index i = 0; i < xy.size(); i += 2) {
    const Vec3 now = X_CnowCthen * (depth * Vec3(xy[i], xy[i + 1], 1.0));
    if (!(now.z() >= kInPicture)) {
      return false;
    }
    again.segment<2>(i) = now.head<2>() / now.z();
  }
  return true;
}

}  // namespace

bool IsStuck(double stuck_shift, const PictureView& view, StuckPicture& picture) noexcept {
  if (!picture.started || view.since_ns != picture.since_ns) {
    picture = {true, view.since_ns, view.X_BC_since, view.p_CO_C, view.xy};
  }
  if (ShiftOfScene(picture.X_BC, view.X_BC, picture.p_CO_C) <= stuck_shift) {
    return false;
  }
  const model::Pose X_CnowCthen = view.X_BC.Inverse() * picture.X_BC;
  if (view.xy.size() == 0 || view.xy.size() != picture.xy.size()) {
    return Off2(view.p_CO_C, picture.p_CO_C) < Off2(view.p_CO_C, X_CnowCthen * picture.p_CO_C);
  }
  SeenCorners::Vector at_rest;
  return !SeeAgain(picture.xy, picture.p_CO_C.z(), X_CnowCthen, at_rest) ||
         Off2(view.xy, picture.xy) < Off2(view.xy, at_rest);
}

}  // namespace fovea::estimate
