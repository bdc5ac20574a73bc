// SPDX-License-Identifier: Apache-2.0
#include "firmware/core/estimate/pose_hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {
namespace {

using features::Polygon;
using features::SeenCorners;

constexpr double kSameNormal = 0.15;  // normals no further apart are the same [rad]
constexpr double kSameTurn = 0.02;    // poses closer than this are the same [rad]
constexpr double kSteepest = 0.2;     // cosine of a disc's tilt, below which its outline tells little
constexpr double kSlip = 0.05;        // a filter that is further from the still pose may have slipped [rad]

double TurnBetween(const model::Pose& a, const model::Pose& b) noexcept {
  return model::RotationVector(a.R.lazyProduct(b.R.transpose())).norm();
}

// How the centre of a disc with the normal `n` is off that of the middle of its outline, along the ray `r`:
// this times radius^2 / distance. The near half of a tilted disc looks larger than the far one.
model::Vec3 OffMiddle(const model::Vec3& n, const model::Vec3& r) noexcept {
  const double along = n.dot(r);
  return -along * (n - along * r);
}

// The view's pose whose orientation is nearest to `R_CO`; -1: it has none.
int Nearest(const SeenCorners& seen, const model::Mat3& R_CO) noexcept {
  double nearest = -2.0;
  int pose = -1;
  for (int i = 0; i < seen.num_branches; ++i) {
    // 1 + 2 cos of the turn between them
    const double likeness = seen.branches[static_cast<std::size_t>(i)].X_CO.R.cwiseProduct(R_CO).sum();
    if (likeness > nearest) {
      nearest = likeness;
      pose = i;
    }
  }
  return pose;
}

Verdict TakenBy(const CornerView& view, const PoseHypotheses& hypotheses) noexcept {
  const model::Mat3& R_BO = hypotheses.plate.best().filter.X_BO.R;
  return {hal::Intake::kTaken, Nearest(view.seen, view.X_CB.R * R_BO)};
}

// Restarts with the poses of `view`. False, with nothing changed, if it has none.
bool Start(const Polygon& polygon, const CornerView& view, PoseHypotheses& hypotheses) noexcept {
  PoseHypotheses start;
  for (int i = 0; i < view.seen.num_branches; ++i) {
    PlatePose& plate = start.plate.all[static_cast<std::size_t>(start.plate.count)];
    if (StartPose(polygon, view, view.seen.branches[static_cast<std::size_t>(i)], plate.filter)) {
      plate.X_BO_still = plate.filter.X_BO;
      ++start.plate.count;
    }
  }
  if (start.plate.count == 0) {
    return false;
  }
  start.plate_mean = SeePlate(view);
  start.plate.views.Keep(start.plate_mean);
  start.accepted = 1;
  start.stamp_ns = view.stamp_ns;
  hypotheses = start;
  return true;
}

// Where two poses merge, a filter may slip from one to the other. The views from other places reveal it.
bool HasSlipped(const Polygon& polygon, const PoseHypotheses& hypotheses) noexcept {
  const PlatePose& left = hypotheses.plate.best();
  return hypotheses.plate.count == 1 && TurnBetween(left.filter.X_BO, left.X_BO_still) > kSlip &&
         MisfitOf(polygon, hypotheses.plate.views.kept(), hypotheses.comparison.newest, left.filter.X_BO) >
             left.still_misfit + PlatePose::kRule.give_up;
}

// Sets a filter that has slipped back to the pose that fits all views.
void CatchSlip(const Polygon& polygon, const CornerView& view, PoseHypotheses& hypotheses) noexcept {
  PlatePose& left = hypotheses.plate.best();
  SeenCorners::Vector expected;
  if (hypotheses.slipped && ExpectCorners(polygon, view.X_CB, left.X_BO_still, expected)) {
    const SeenCorners::Branch still{view.X_CB * left.X_BO_still, NearestFirst(view.seen.xy, expected)};
    (void)StartPose(polygon, view, still, left.filter);
  }
  hypotheses.slipped = false;
}

void BeginComparison(const Polygon& polygon, const CornerView& view, PoseHypotheses& hypotheses) noexcept {
  PlateComparison& comparison = hypotheses.comparison;
  comparison.runs = true;
  comparison.ended = false;
  comparison.pose = 0;  // the others begin as the last comparison left them: 0
  comparison.newest = SeePlate(view);
  const PlatePose& best = hypotheses.plate.best();
  comparison.late_sigma = std::sqrt(std::max(best.filter.P(PoseFilter::kLate, PoseFilter::kLate), 0.0));
  const bool is_sure = hypotheses.plate.count == 1;
  TakeIntoMean(polygon, comparison.newest, is_sure ? &best.X_BO_still : nullptr, hypotheses.plate_mean);
  hypotheses.plate.views.Keep(comparison.newest);
}

// All hypotheses are fitted: keeps those that fit.
void EndComparison(const Polygon& polygon, PoseHypotheses& hypotheses) noexcept {
  auto& plate = hypotheses.plate;
  const PlateView& newest = hypotheses.comparison.newest;
  hypotheses.comparison.runs = false;
  hypotheses.comparison.ended = true;
  (void)plate.Choose(static_cast<double>((plate.views.count + 1) * newest.xy.size()));
  if (plate.stillness == Stillness::kMoving) {
    plate.views.Forget();
    plate.views.Keep(newest);
    hypotheses.plate_mean = newest;
    for (std::size_t i = 0; i < static_cast<std::size_t>(plate.count); ++i) {
      plate.all[i].X_BO_still = plate.all[i].filter.X_BO;
    }
  } else {
    hypotheses.slipped = HasSlipped(polygon, hypotheses);
  }
}

}  // namespace

bool DiscNormal::IsSame(const DiscNormal& other) const noexcept {
  return !((normal_B - other.normal_B).norm() > kSameNormal);
}

bool PlatePose::IsSame(const PlatePose& other) const noexcept {
  return TurnBetween(X_BO_still, other.X_BO_still) < kSameTurn;
}

Verdict TakeView(const hal::FeatureMeasurement& measurement, const model::Pose& X_BC,
                 PoseHypotheses& hypotheses) noexcept {
  DiscView view;
  if (!SeeDisc(measurement, X_BC, view)) {
    return {.pose = 0};
  }
  auto& disc = hypotheses.disc;
  if (disc.count == 0) {
    disc.all[0].normal_B = view.normal_B[0];
  }
  const DiscNormal before = disc.all[0];
  disc.all[1].normal_B = view.normal_B[0];
  disc.all[2].normal_B = view.normal_B[1];
  disc.count = 3;
  for (DiscNormal& normal : disc.all) {
    normal.still_misfit = FitNormal(disc.views.kept(), view, normal.normal_B);
  }
  (void)disc.Choose(static_cast<double>(disc.views.count + 1));
  DiscNormal& best = disc.best();
  if (disc.stillness == Stillness::kMoving) {
    disc.views.count = 0;  // keeps the views' step
    best.normal_B = view.normal_B[static_cast<std::size_t>(Nearer(view, before.normal_B))];
  }
  disc.views.Keep(view);
  // The normal of all views is better than that of this one. Seen nearly from the front, a disc's tilt is
  // lost in the noise of its outline.
  const int nearer = Nearer(view, best.normal_B);
  const model::Vec3& seen = view.normal_B[static_cast<std::size_t>(nearer)];
  // Both half axes of the outline, a and a cos(tilt), tell the size.
  const double cosine = std::fabs(best.normal_B.dot(view.ray_B));
  const double farther = cosine > kSteepest ? 2.0 / (1.0 + std::fabs(seen.dot(view.ray_B)) / cosine) : 1.0;
  return {hal::Intake::kTaken, nearer, !before.IsSame(best), farther,
          OffMiddle(best.normal_B, view.ray_B) - OffMiddle(seen, view.ray_B)};
}

Verdict TakeView(const config::PredictConfig& config, const Polygon& polygon, const CornerView& view,
                 PoseHypotheses& hypotheses) noexcept {
  auto& plate = hypotheses.plate;
  if (plate.count == 0) {
    return Start(polygon, view, hypotheses) ? TakenBy(view, hypotheses) : Verdict{hal::Intake::kWrongKind};
  }
  if (view.stamp_ns <= hypotheses.stamp_ns) {
    return {hal::Intake::kTooOld};
  }
  const double gate2 = config.gate_sigma * config.gate_sigma;
  bool fits = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(plate.count); ++i) {
    double distance2 = 0.0;
    fits = UpdatePose(config, polygon, view, plate.all[i].filter, distance2) || fits;
    plate.all[i].motion_misfit += std::min(distance2, gate2);
  }
  if (!fits) {
    if (hypotheses.rejected_in_row + 1 >= config.gate_rejects_max && Start(polygon, view, hypotheses)) {
      return TakenBy(view, hypotheses);
    }
    hypotheses.rejected_in_row = std::min(hypotheses.rejected_in_row + 1, config.gate_rejects_max);
    return {hal::Intake::kOutlier};
  }
  CatchSlip(polygon, view, hypotheses);
  if (!hypotheses.comparison.runs) {
    BeginComparison(polygon, view, hypotheses);
  }
  hypotheses.stamp_ns = view.stamp_ns;
  hypotheses.rejected_in_row = 0;
  hypotheses.accepted = std::min(hypotheses.accepted + 1, config.accepted_min);
  return TakenBy(view, hypotheses);
}

bool GoOn(const Polygon& polygon, PoseHypotheses& hypotheses) noexcept {
  PlateComparison& comparison = hypotheses.comparison;
  if (!comparison.runs) {
    comparison.ended = false;
    return false;
  }
  PlatePose& pose = hypotheses.plate.all[static_cast<std::size_t>(comparison.pose)];
  const auto views = hypotheses.plate.views.kept();
  const auto count = static_cast<std::int32_t>(views.size()) + 1;
  if (comparison.next < count) {
    const std::int32_t end = std::min<std::int32_t>(comparison.next + PlateComparison::kViewsInTick, count);
    for (; comparison.next < end; ++comparison.next) {
      const std::int32_t i = comparison.next;
      PlateView& view =
          i == 0 ? hypotheses.plate_mean : hypotheses.plate.views.views[static_cast<std::size_t>(i - 1)];
      MoveToAge(comparison.newest.late, view);
      comparison.fit.Add(polygon, view, pose.X_BO_still);
    }
    return true;
  }
  comparison.fit.Improve(comparison.late_sigma, pose.X_BO_still);
  pose.still_misfit = MisfitOf(polygon, views, comparison.newest, pose.X_BO_still);
  comparison.fit = PlateFit{};
  comparison.next = 0;
  if (++comparison.pose >= hypotheses.plate.count) {
    EndComparison(polygon, hypotheses);
  }
  return true;
}

FlatMotion MotionAt(const config::PredictConfig& config, const PoseHypotheses& hypotheses,
                    std::int64_t now_ns) noexcept {
  const PlatePose& believed = hypotheses.plate.best();
  if (hypotheses.plate.stillness == Stillness::kStill) {
    return {believed.X_BO_still, model::Vec3::Zero(), model::Vec3::Zero()};
  }
  return MotionAt(config, believed.filter, now_ns);
}

}  // namespace fovea::estimate
