// SPDX-License-Identifier: Apache-2.0
// Finds the true one of the poses that fit a picture of the target.
//
// Two poses fit a disc's outline exactly, up to four fit three corners. hypothesis_set.hpp has the rule that
// tells them apart as the camera moves. A disc's hypotheses are normals: the believed one and the two of each
// view. The others are dropped, because the next view shows both again. A flat target's hypotheses are the
// poses of its first view, until they are dropped. Each also has a filter (pose_filter.hpp). If none stands
// still, the one that moves most smoothly is believed.
//
// A ball has no such ambiguity.
#pragma once

#include <cstdint>
#include <limits>

#include "firmware/core/estimate/disc_fit.hpp"
#include "firmware/core/estimate/hypothesis_set.hpp"
#include "firmware/core/estimate/plate_fit.hpp"
#include "firmware/core/estimate/pose_filter.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::estimate {

struct DiscNormal {
  static constexpr ChoiceRule kRule{.switch_margin = 12.0,
                                    .still_most = 8.0,
                                    .still_credit = 12.0,
                                    .views_to_tell = 4,
                                    .give_up = -std::numeric_limits<double>::infinity()};

  model::Vec3 normal_B = model::Vec3::UnitZ();
  double still_misfit = 0.0;  // of the normal from all views

  // There is no other evidence for a disc that turns.
  [[nodiscard]] double MisfitOfMotion() const noexcept { return still_misfit; }
  [[nodiscard]] bool IsSame(const DiscNormal& other) const noexcept;
};

struct PlatePose {
  static constexpr ChoiceRule kRule{
      .switch_margin = 6.0, .still_most = 4.0, .still_credit = 0.0, .views_to_tell = 4, .give_up = 50.0};

  PoseFilter filter;
  model::Pose X_BO_still;
  double motion_misfit = 0.0;  // sum of the filter's squared innovations, in standard deviations
  double still_misfit = 0.0;   // of the still pose from all views, in the same unit

  [[nodiscard]] double MisfitOfMotion() const noexcept { return motion_misfit; }
  [[nodiscard]] bool IsSame(const PlatePose& other) const noexcept;
};

// The comparison of a flat target's hypotheses with all views. It takes more than a tick may take, so each
// tick does a share of it, with the same result. A view that comes meanwhile only updates the filters.
struct PlateComparison {
  static constexpr int kViewsInTick = 4;  // that are fitted

  bool runs = false;
  bool ended = false;     // in this tick
  std::int32_t pose = 0;  // number of the hypothesis
  std::int32_t next = 0;  // view to fit it to: 0 is the mean, then the kept ones; then its misfit is computed
  PlateFit fit;
  PlateView newest;         // with which it began
  double late_sigma = 0.0;  // of the frames' age, then [s]
};

// A target has one kind. The other kind's set stays empty.
struct PoseHypotheses {
  HypothesisSet<DiscNormal, 3, DiscView, 12> disc;
  HypothesisSet<PlatePose, hal::kMaxPoses, PlateView, 16> plate;

  // of a flat target
  PlateView plate_mean;  // of the frames since the camera stands still or trembles
  PlateComparison comparison;
  bool slipped = false;  // the believed pose's filter has slipped to another pose
  int accepted = 0;      // views since the start, up to accepted_min
  int rejected_in_row = 0;
  std::int64_t stamp_ns = 0;  // of the last accepted view
};

// The result of a view.
struct Verdict {
  hal::Intake intake = hal::Intake::kTaken;
  int pose = -1;         // the measurement's pose nearest to the believed one; -1: it has none
  bool changed = false;  // of a disc: another hypothesis is believed than before
  // Of a disc: its distance relative to the measured pose's; then its centre in B is off by this times
  // radius^2 / distance.
  double farther = 1.0;
  model::Vec3 off_B = model::Vec3::Zero();
};

// Adds a measurement of a circle with both its poses, by a camera at `X_BC`. The first view's first pose is
// believed until other views contradict it. If a pose is invalid, nothing changes, and the first pose counts.
// Real-time: yes.
[[nodiscard]] Verdict TakeView(const hal::FeatureMeasurement& measurement, const model::Pose& X_BC,
                               PoseHypotheses& hypotheses) noexcept;

// Adds a view of a flat target, and begins to compare it. Rejects a view that fits no hypothesis as an
// outlier. After too many in a row, the hypotheses restart with the poses of that view. Real-time: yes.
[[nodiscard]] Verdict TakeView(const config::PredictConfig& config, const features::Polygon& polygon,
                               const CornerView& view, PoseHypotheses& hypotheses) noexcept;

// Call in each tick: does a share of the comparison. False if there is nothing to do. Real-time: yes.
bool GoOn(const features::Polygon& polygon, PoseHypotheses& hypotheses) noexcept;

// The believed pose of a flat target at `now_ns`. For a target at rest it is the pose that fits all views.
// While the camera stands still, the corner errors are constant. A filter would treat each view as
// independent, and would forget the tilt, which views from the side show much better. If arm, camera and
// corners disagree by more than some tenths of a pixel, nothing counts as still, and the filter's pose is
// used. Real-time: yes.
[[nodiscard]] FlatMotion MotionAt(const config::PredictConfig& config, const PoseHypotheses& hypotheses,
                                  std::int64_t now_ns) noexcept;

}  // namespace fovea::estimate
