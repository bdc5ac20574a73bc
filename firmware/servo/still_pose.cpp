#include "fovea/servo/still_pose.hpp"

#include "fovea/model/cholesky.hpp"
#include "fovea/model/rotation.hpp"

namespace fovea::servo {
namespace {

using features::Polygon;
using features::SeenCorners;

constexpr int kRounds = 2;             // of Gauss-Newton, each time: the pose is near from the view before
constexpr double kCalibration = 2e-4;  // what arm, camera and lens are not known to, in the normalised image
constexpr double kStepM = 0.05;        // steps are held back by these, so that none leaps where the corners
constexpr double kStepRad = 0.05;      // say nothing
constexpr double kNoWay = 1e9;

StillViews::View ViewOf(const CornerView& view) noexcept {
  const double variance = view.seen.cov.trace() / static_cast<double>(view.seen.xy.size());
  return {view.X_CB, view.seen.xy, 1.0 / (variance + kCalibration * kCalibration)};
}

// What views say of a pose: how badly it fits, and which way it fits better.
struct Fit {
  double misfit = 0.0;
  model::Mat6 information = model::Mat6::Zero();
  model::Vec6 right = model::Vec6::Zero();
};

// One view's share; false when a corner is not before the camera.
bool AddTo(Fit& fit, const Polygon& polygon, const StillViews::View& view, const model::Pose& X_BO) noexcept {
  SeenCorners::Vector expected;
  if (!ExpectCorners(polygon, view.X_CB, X_BO, expected)) {
    return false;
  }
  const int n = polygon.num_corners;
  const int first = NearestFirst(view.xy, expected);
  SeenCorners::Vector e(2 * n);
  for (int i = 0; i < n; ++i) {
    e.segment<2>(2 * i) = view.xy.segment<2>(2 * ((first + i) % n)) - expected.segment<2>(2 * i);
  }
  CornerSlope H;
  SlopeOfCorners(polygon, view.X_CB, X_BO, H);
  fit.misfit += view.weight * e.squaredNorm();
  fit.information += view.weight * H.transpose().lazyProduct(H);
  fit.right += view.weight * H.transpose().lazyProduct(e);
  return true;
}

Fit FitAt(const Polygon& polygon, const StillViews& views, const CornerView& newest,
          const model::Pose& X_BO) noexcept {
  Fit fit;
  bool seen = AddTo(fit, polygon, ViewOf(newest), X_BO);
  for (std::size_t i = 0; i < static_cast<std::size_t>(views.count); ++i) {
    seen = seen && AddTo(fit, polygon, views.views[i], X_BO);
  }
  if (!seen || !(fit.misfit < kNoWay)) {
    fit.misfit = kNoWay;
  }
  return fit;
}

}  // namespace

void AddView(const CornerView& view, StillViews& views) noexcept {
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
  return FitAt(polygon, views, newest, X_BO).misfit;
}

double FitStill(const Polygon& polygon, const StillViews& views, const CornerView& newest,
                model::Pose& X_BO) noexcept {
  for (int round = 0; round < kRounds; ++round) {
    Fit fit = FitAt(polygon, views, newest, X_BO);
    fit.information.diagonal().head<3>().array() += 1.0 / (kStepM * kStepM);
    fit.information.diagonal().tail<3>().array() += 1.0 / (kStepRad * kStepRad);
    model::FactorCholesky(fit.information);
    model::SolveCholesky(fit.information, fit.right);
    if (!(fit.misfit < kNoWay) || !fit.right.allFinite()) {
      return kNoWay;
    }
    X_BO.p += fit.right.head<3>();
    X_BO.R = model::RotationOf(fit.right.tail<3>()) * X_BO.R;
  }
  return MisfitOf(polygon, views, newest, X_BO);
}

}  // namespace fovea::servo
