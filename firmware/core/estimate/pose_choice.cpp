#include "firmware/core/estimate/pose_choice.hpp"

#include <algorithm>

#include "firmware/core/model/rotation.hpp"

namespace fovea::estimate {
namespace {

using features::Polygon;
using features::SeenCorners;

constexpr double kGiveUp = 50.0;       // so much more misfit is no chance [sigma^2]
constexpr double kSwitchMargin = 6.0;  // so much less, and another branch is believed [sigma^2]
constexpr double kStill = 4.0;   // a target whose best still pose fits worse is none, per entry [sigma^2]
constexpr int kViewsToTell = 4;  // so many, from different places, before it counts as one that stands still
constexpr double kSameTurn = 0.02;  // branches nearer to each other than this are one [rad]
constexpr double kSlip = 0.05;      // a filter that is further from the still pose may have slipped [rad]

double TurnBetween(const model::Pose& a, const model::Pose& b) noexcept {
  return model::RotationVector(a.R.lazyProduct(b.R.transpose())).norm();
}

bool Start(const Polygon& polygon, const CornerView& view, PoseChoice& choice) noexcept {
  PoseChoice start;
  for (int i = 0; i < view.seen.num_branches; ++i) {
    PoseChoice::Branch& branch = start.branches[static_cast<std::size_t>(start.num_branches)];
    if (StartPose(polygon, view, view.seen.branches[static_cast<std::size_t>(i)], branch.filter)) {
      branch.X_BO_still = branch.filter.X_BO;
      ++start.num_branches;
    }
  }
  if (start.num_branches == 0) {
    return false;
  }
  AddView(view, start.views);
  start.accepted = 1;
  start.stamp_ns = view.stamp_ns;
  choice = start;
  return true;
}

// Hopeless branches go, and of two that have met the worse one. Whether the
// target stands still by all that is known.
bool Weed(PoseChoice& choice) noexcept {
  const auto n = static_cast<std::size_t>(choice.num_branches);
  auto& branches = choice.branches;
  double least = branches[0].still_misfit;
  for (std::size_t i = 1; i < n; ++i) {
    least = std::min(least, branches[i].still_misfit);
  }
  const auto entries = static_cast<double>((choice.views.count + 1) * choice.views.views[0].xy.size());
  const bool still = least <= kStill * entries;
  const auto misfit = [&](std::size_t i) { return still ? branches[i].still_misfit : branches[i].misfit; };
  std::size_t best = 0;
  for (std::size_t i = 1; i < n; ++i) {
    best = misfit(i) < misfit(best) ? i : best;
  }
  auto believed = static_cast<std::size_t>(choice.believed);
  if (misfit(believed) > misfit(best) + kSwitchMargin) {
    believed = best;
  }
  std::array<bool, hal::kMaxPoses> stays{};
  for (std::size_t i = 0; i < n; ++i) {
    stays[i] = i == believed || misfit(i) <= misfit(best) + kGiveUp;
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const bool better = j == believed || (i != believed && misfit(j) < misfit(i));
      if (i != j && stays[i] && stays[j] && better &&
          TurnBetween(branches[i].X_BO_still, branches[j].X_BO_still) < kSameTurn) {
        stays[i] = false;
      }
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!stays[i]) {
      continue;
    }
    if (i == believed) {
      choice.believed = static_cast<int>(kept);
    }
    if (kept != i) {
      branches[kept] = branches[i];
    }
    ++kept;
  }
  choice.num_branches = static_cast<int>(kept);
  return still;
}

// Takes what all views say together, and keeps the branches that it allows.
void Compare(const Polygon& polygon, const CornerView& view, PoseChoice& choice) noexcept {
  AddView(view, choice.views);
  for (std::size_t i = 0; i < static_cast<std::size_t>(choice.num_branches); ++i) {
    PoseChoice::Branch& branch = choice.branches[i];
    FitStill(polygon, choice.views, branch.X_BO_still);
    branch.still_misfit = MisfitOf(polygon, choice.views, view, branch.X_BO_still);
  }
  const bool fits = Weed(choice);
  choice.is_still = fits && choice.views.count >= kViewsToTell;
  if (!fits) {
    // It moves: what it showed from elsewhere says nothing more.
    choice.views = StillViews{};
    AddView(view, choice.views);
    for (PoseChoice::Branch& branch : choice.branches) {
      branch.X_BO_still = branch.filter.X_BO;
    }
    return;
  }
  // Where two poses are one, a filter may slip from one to the other. The views from elsewhere tell.
  PoseChoice::Branch& left = choice.branches[static_cast<std::size_t>(choice.believed)];
  SeenCorners::Vector expected;
  if (choice.num_branches == 1 && TurnBetween(left.filter.X_BO, left.X_BO_still) > kSlip &&
      MisfitOf(polygon, choice.views, view, left.filter.X_BO) > left.still_misfit + kGiveUp &&
      ExpectCorners(polygon, view.X_CB, left.X_BO_still, expected)) {
    const SeenCorners::Branch still{view.X_CB * left.X_BO_still, NearestFirst(view.seen.xy, expected)};
    (void)StartPose(polygon, view, still, left.filter);
  }
}

}  // namespace

hal::Intake UpdatePoses(const config::PredictConfig& config, const Polygon& polygon, const CornerView& view,
                        PoseChoice& choice) noexcept {
  if (choice.num_branches == 0) {
    return Start(polygon, view, choice) ? hal::Intake::kTaken : hal::Intake::kWrongKind;
  }
  if (view.stamp_ns <= choice.stamp_ns) {
    return hal::Intake::kTooOld;
  }
  const double gate2 = config.gate_sigma * config.gate_sigma;
  bool fits = false;
  for (std::size_t i = 0; i < static_cast<std::size_t>(choice.num_branches); ++i) {
    double distance2 = 0.0;
    fits = UpdatePose(config, polygon, view, choice.branches[i].filter, distance2) || fits;
    choice.branches[i].misfit += std::min(distance2, gate2);
  }
  if (!fits) {
    if (choice.rejected_in_row + 1 >= config.gate_rejects_max && Start(polygon, view, choice)) {
      return hal::Intake::kTaken;
    }
    choice.rejected_in_row = std::min(choice.rejected_in_row + 1, config.gate_rejects_max);
    return hal::Intake::kOutlier;
  }
  Compare(polygon, view, choice);
  choice.stamp_ns = view.stamp_ns;
  choice.rejected_in_row = 0;
  choice.accepted = std::min(choice.accepted + 1, config.accepted_min);
  return hal::Intake::kTaken;
}

FlatMotion MotionAt(const config::PredictConfig& config, const PoseChoice& choice,
                    std::int64_t now_ns) noexcept {
  if (choice.is_still) {
    const PoseChoice::Branch& believed = choice.branches[static_cast<std::size_t>(choice.believed)];
    return {believed.X_BO_still, model::Vec3::Zero(), model::Vec3::Zero()};
  }
  return MotionAt(config, choice.best(), now_ns);
}

}  // namespace fovea::estimate
