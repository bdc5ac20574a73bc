// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/plate_fit.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/model/cholesky.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {
namespace {

using features::Polygon;
using features::SeenCorners;

constexpr double kCalibration = 2e-4;  // uncertainty of arm, camera and lens, in the normalised image
constexpr double kStepM = 0.05;        // sizes that damp a step, so that it does not jump in directions
constexpr double kStepRad = 0.05;      // that the corners do not determine
constexpr double kHereM = 5e-5;        // a camera that has moved no further stands still: corners at
constexpr double kHereRad = 1e-4;      // 0.25 m and further shift by no more than kCalibration
constexpr double kTrembleM = 5e-4;     // a camera that moves no further between two frames trembles
constexpr double kTrembleRad = 2e-3;
constexpr double kSameAge = 1e-4;            // a camera at 0.5 m/s moves by 50 um [s]
constexpr double kLeastAgeVariance = 1e-12;  // [s^2]
constexpr int kFramesMost = 60;              // largest number in a mean
constexpr double kNoFit = 1e9;               // misfit of a pose that the corners cannot have

double WeightOf(double variance, int frames) noexcept {
  return 1.0 / (variance / frames + kCalibration * kCalibration);
}

// The distances of a view's corners from their places at `X_BO`, in the polygon's order. False if one is not
// in front of the camera.
bool OffFrom(const Polygon& polygon, const PlateView& view, const model::Pose& X_BO,
             SeenCorners::Vector& e) noexcept {
  SeenCorners::Vector expected;
  if (!ExpectCorners(polygon, view.X_CB, X_BO, expected)) {
    return false;
  }
  const int n = polygon.num_corners;
  const int first = NearestFirst(view.xy, expected);
  e.resize(2 * n);
  for (int i = 0; i < n; ++i) {
    e.segment<2>(2 * i) = view.xy.segment<2>(2 * ((first + i) % n)) - expected.segment<2>(2 * i);
  }
  return true;
}

// The derivative of the expected corners by the frame's age [1/s]: how they move as the camera goes back.
SeenCorners::Vector SlopeByAge(const Polygon& polygon, const PlateView& view,
                               const model::Pose& X_BO) noexcept {
  const model::Pose X_CO = view.X_CB * X_BO;
  SeenCorners::Vector slope(2 * polygon.num_corners);
  for (int i = 0; i < polygon.num_corners; ++i) {
    const model::Vec3 p_C = X_CO * polygon.corners[static_cast<std::size_t>(i)];
    const model::Vec3 v_C = view.V_BC_C.head<3>() + model::Cross(view.V_BC_C.tail<3>(), p_C);
    slope.segment<2>(2 * i) = (v_C.head<2>() - p_C.head<2>() * (v_C.z() / p_C.z())) / p_C.z();
  }
  return slope;
}

// How far the camera of `view` is from `X_CB`.
struct Moved {
  double m;
  double rad;
  [[nodiscard]] bool IsWithin(double most_m, double most_rad) const noexcept {
    return m < most_m && rad < most_rad;
  }
};
Moved MovedFrom(const PlateView& view, const model::Pose& X_CB) noexcept {
  const model::Pose moved = X_CB * view.X_CB.Inverse();
  return {moved.p.norm(), model::RotationVector(moved.R).norm()};
}

// Moves `mean` to the camera of `newest`, as it sees a target at `X_BO`. False if a corner is not in front of
// the camera.
bool MoveTo(const Polygon& polygon, const PlateView& newest, const model::Pose& X_BO,
            PlateView& mean) noexcept {
  SeenCorners::Vector before;
  SeenCorners::Vector now;
  if (!ExpectCorners(polygon, mean.X_CB, X_BO, before) || !ExpectCorners(polygon, newest.X_CB, X_BO, now)) {
    return false;
  }
  const int n = polygon.num_corners;
  const int first = NearestFirst(mean.xy, before);
  for (int i = 0; i < n; ++i) {
    mean.xy.segment<2>(2 * ((first + i) % n)) += now.segment<2>(2 * i) - before.segment<2>(2 * i);
  }
  mean.X_CB = newest.X_CB;
  return true;
}

// Makes `mean` the mean of itself and of `newest`, taken from the same place.
void Average(const PlateView& newest, PlateView& mean) noexcept {
  mean.frames = std::min(mean.frames + 1, kFramesMost);
  const auto n = static_cast<int>(mean.xy.size() / 2);
  const int first = NearestFirst(newest.xy, mean.xy);
  for (int i = 0; i < n; ++i) {
    mean.xy.segment<2>(2 * i) +=
        (newest.xy.segment<2>(2 * ((first + i) % n)) - mean.xy.segment<2>(2 * i)) / mean.frames;
  }
  mean.V_BC_C += (newest.V_BC_C - mean.V_BC_C) / mean.frames;
}

}  // namespace

PlateView SeePlate(const CornerView& view) noexcept {
  const double variance = view.seen.cov.trace() / static_cast<double>(view.seen.xy.size());
  return {view.X_CB, view.seen.xy, variance, 1, view.late, view.V_BC_C};
}

void MoveToAge(double late, PlateView& view) noexcept {
  const double earlier = late - view.late;
  if (!(std::fabs(earlier) > kSameAge)) {
    return;
  }
  // X_BC' = X_BC exp(-earlier V), to second order.
  const model::Vec3 v = earlier * view.V_BC_C.head<3>();
  const model::Vec3 w = earlier * view.V_BC_C.tail<3>();
  view.X_CB = model::Pose{model::RotationOf(w), v + 0.5 * model::Cross(w, v)} * view.X_CB;
  view.late = late;
}

void TakeIntoMean(const Polygon& polygon, const PlateView& newest, const model::Pose* X_BO,
                  PlateView& mean) noexcept {
  MoveToAge(newest.late, mean);
  const Moved moved = MovedFrom(mean, newest.X_CB);
  const bool trembles =
      X_BO != nullptr && moved.IsWithin(kTrembleM, kTrembleRad) && MoveTo(polygon, newest, *X_BO, mean);
  if (trembles || moved.IsWithin(kHereM, kHereRad)) {
    Average(newest, mean);
  } else {
    mean = newest;
  }
}

double MisfitOf(const Polygon& polygon, std::span<const PlateView> views, const PlateView& newest,
                const model::Pose& X_BO) noexcept {
  double misfit = 0.0;
  const auto add = [&](const PlateView& view) {
    SeenCorners::Vector e;
    const bool seen = OffFrom(polygon, view, X_BO, e);
    misfit = seen ? misfit + WeightOf(view.variance, view.frames) * e.squaredNorm() : kNoFit;
    return misfit < kNoFit;
  };
  const bool fits = add(newest) && std::all_of(views.begin(), views.end(), add);
  return fits ? misfit : kNoFit;
}

void PlateFit::Add(const Polygon& polygon, const PlateView& view, const model::Pose& X_BO) noexcept {
  SeenCorners::Vector e;
  is_possible_ = is_possible_ && OffFrom(polygon, view, X_BO, e);
  if (!is_possible_) {
    return;
  }
  CornerSlope H;
  SlopeOfCorners(polygon, view.X_CB, X_BO, H);
  Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::ColMajor, 2 * Polygon::kMost, 7> A(H.rows(), 7);
  A.leftCols<6>() = H;
  A.col(kLate) = SlopeByAge(polygon, view, X_BO);
  const double weight = WeightOf(view.variance, view.frames);
  information_ += weight * A.transpose().lazyProduct(A);
  right_ += weight * A.transpose().lazyProduct(e);
}

void PlateFit::Improve(double late_sigma, model::Pose& X_BO) const noexcept {
  Eigen::Matrix<double, 7, 7> information = information_;
  Eigen::Matrix<double, 7, 1> step = right_;
  information.diagonal().head<3>().array() += 1.0 / (kStepM * kStepM);
  information.diagonal().segment<3>(3).array() += 1.0 / (kStepRad * kStepRad);
  information(kLate, kLate) += 1.0 / std::max(late_sigma * late_sigma, kLeastAgeVariance);
  model::FactorCholesky(information);
  model::SolveCholesky(information, step);
  if (!is_possible_ || !step.allFinite()) {
    return;
  }
  X_BO.p += step.head<3>();
  X_BO.R = model::RotationOf(step.segment<3>(3)) * X_BO.R;
}

}  // namespace fovea::estimate
