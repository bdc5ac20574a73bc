#include "firmware/core/estimate/still_pose.hpp"

#include <algorithm>

#include "firmware/core/model/cholesky.hpp"
#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {
namespace {

using features::Polygon;
using features::SeenCorners;

constexpr double kCalibration = 2e-4;  // what arm, camera and lens are not known to, in the normalised image
constexpr double kStepM = 0.05;        // steps are held back by these, so that none leaps where the corners
constexpr double kStepRad = 0.05;      // say nothing
constexpr double kHereM = 5e-5;        // a camera that has moved no further stands where it was: corners at
constexpr double kHereRad = 1e-4;      // 0.25 m and further shift by no more than kCalibration
constexpr int kFramesMost = 60;        // whose mean a view is
constexpr double kNoWay = 1e9;

double WeightOf(double variance, int frames) noexcept {
  return 1.0 / (variance / frames + kCalibration * kCalibration);
}

StillViews::View ViewOf(const CornerView& view) noexcept {
  const double variance = view.seen.cov.trace() / static_cast<double>(view.seen.xy.size());
  return {view.X_CB, view.seen.xy, variance, 1};
}

// How far the corners of a view are from where `X_BO` has them, in the polygon's order. False when one is
// not before the camera.
bool OffFrom(const Polygon& polygon, const StillViews::View& view, const model::Pose& X_BO,
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

// Whether the camera has stayed where `view` was taken from.
bool IsFromHere(const StillViews::View& view, const model::Pose& X_CB) noexcept {
  const model::Pose moved = X_CB * view.X_CB.Inverse();
  return moved.p.norm() < kHereM && model::RotationVector(moved.R).norm() < kHereRad;
}

// Makes `view` the mean of itself and of `newest`, taken from the same place.
void Average(const CornerView& newest, StillViews::View& view) noexcept {
  view.frames = std::min(view.frames + 1, kFramesMost);
  const auto n = static_cast<int>(view.xy.size() / 2);
  const int first = NearestFirst(newest.seen.xy, view.xy);
  for (int i = 0; i < n; ++i) {
    view.xy.segment<2>(2 * i) +=
        (newest.seen.xy.segment<2>(2 * ((first + i) % n)) - view.xy.segment<2>(2 * i)) / view.frames;
  }
}

// What views say of a pose: which way it fits better.
struct Fit {
  model::Mat6 information = model::Mat6::Zero();
  model::Vec6 right = model::Vec6::Zero();
};

// One view's share; false when a corner is not before the camera.
bool AddTo(Fit& fit, const Polygon& polygon, const StillViews::View& view, const model::Pose& X_BO) noexcept {
  SeenCorners::Vector e;
  if (!OffFrom(polygon, view, X_BO, e)) {
    return false;
  }
  CornerSlope H;
  SlopeOfCorners(polygon, view.X_CB, X_BO, H);
  const double weight = WeightOf(view.variance, view.frames);
  fit.information += weight * H.transpose().lazyProduct(H);
  fit.right += weight * H.transpose().lazyProduct(e);
  return true;
}

}  // namespace

void AddView(const CornerView& view, StillViews& views) noexcept {
  if (views.count > 0 && IsFromHere(views.here, view.X_CB)) {
    Average(view, views.here);
  } else {
    views.here = ViewOf(view);
  }
  if (views.count > 0) {
    const model::Pose& last = views.views[static_cast<std::size_t>(views.count - 1)].X_CB;
    if (!((last.Inverse().p - view.X_CB.Inverse().p).norm() >= views.step)) {
      return;
    }
  }
  if (views.count == StillViews::kMost) {
    for (std::size_t i = 1; 2 * i < StillViews::kMost; ++i) {
      views.views[i] = views.views[2 * i];
    }
    views.count = StillViews::kMost / 2;
    views.step *= 2.0;
  }
  views.views[static_cast<std::size_t>(views.count++)] = ViewOf(view);
}

double MisfitOf(const Polygon& polygon, const StillViews& views, const CornerView& newest,
                const model::Pose& X_BO) noexcept {
  double misfit = 0.0;
  const auto add = [&](const StillViews::View& view) {
    SeenCorners::Vector e;
    const bool seen = OffFrom(polygon, view, X_BO, e);
    misfit = seen ? misfit + WeightOf(view.variance, view.frames) * e.squaredNorm() : kNoWay;
    return misfit < kNoWay;
  };
  bool fits = add(ViewOf(newest));
  for (std::size_t i = 0; fits && i < static_cast<std::size_t>(views.count); ++i) {
    fits = add(views.views[i]);
  }
  return fits ? misfit : kNoWay;
}

bool FitStill(const Polygon& polygon, const StillViews& views, model::Pose& X_BO) noexcept {
  Fit fit;
  bool seen = AddTo(fit, polygon, views.here, X_BO);
  for (std::size_t i = 0; seen && i < static_cast<std::size_t>(views.count); ++i) {
    seen = AddTo(fit, polygon, views.views[i], X_BO);
  }
  fit.information.diagonal().head<3>().array() += 1.0 / (kStepM * kStepM);
  fit.information.diagonal().tail<3>().array() += 1.0 / (kStepRad * kStepRad);
  model::FactorCholesky(fit.information);
  model::SolveCholesky(fit.information, fit.right);
  if (!seen || !fit.right.allFinite()) {
    return false;
  }
  X_BO.p += fit.right.head<3>();
  X_BO.R = model::RotationOf(fit.right.tail<3>()) * X_BO.R;
  return true;
}

}  // namespace fovea::estimate
