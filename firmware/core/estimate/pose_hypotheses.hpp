// Which of the poses that a picture of the target allows is the true one.
//
// A disc's outline allows two poses, three corners up to four, each exactly. hypothesis_set.hpp has the rule
// that tells them apart as the camera moves. A disc's hypotheses are normals: the one that is believed, and
// with each view the two that it shows; the others are forgotten, since the next view shows both again. A
// flat target's are the poses of its first view, until they are given up; each has a filter (pose_filter.hpp)
// besides, and when none stands still, how smoothly each moves speaks instead.
//
// Of a ball there is nothing to choose.
#pragma once

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

  // Nothing else speaks for or against a disc that turns.
  [[nodiscard]] double MisfitOfMotion() const noexcept { return still_misfit; }
  [[nodiscard]] bool IsSame(const DiscNormal& other) const noexcept;
};

struct PlatePose {
  static constexpr ChoiceRule kRule{
      .switch_margin = 6.0, .still_most = 4.0, .still_credit = 0.0, .views_to_tell = 4, .give_up = 50.0};

  PoseFilter filter;
  model::Pose X_BO_still;
  double motion_misfit = 0.0;  // sum of the filter's squared innovations, in standard deviations
  double still_misfit = 0.0;   // of the still pose from all views, the same

  [[nodiscard]] double MisfitOfMotion() const noexcept { return motion_misfit; }
  [[nodiscard]] bool IsSame(const PlatePose& other) const noexcept;
};

// One target is of one kind: the other's set stays empty.
struct PoseHypotheses {
  HypothesisSet<DiscNormal, 3, DiscView, 12> disc;
  HypothesisSet<PlatePose, hal::kMaxPoses, PlateView, 16> plate;

  // of a flat target
  PlateView plate_mean;  // of the frames since the camera stands where it is
  int accepted = 0;      // views since the start, up to accepted_min
  int rejected_in_row = 0;
  std::int64_t stamp_ns = 0;  // of the last view that was taken in
};

// What became of a view.
struct Verdict {
  hal::Intake intake = hal::Intake::kTaken;
  int pose = -1;         // of the measurement's poses the one nearest to what is believed; -1: it has none
  bool changed = false;  // another hypothesis is believed than before
};

// Takes in a measurement of a circle with both its poses, by a camera at `X_BC`. The first view's first pose
// is believed until the others say otherwise. Where a pose is none, nothing changes, and the first one
// counts. Real-time: yes.
[[nodiscard]] Verdict TakeView(const hal::FeatureMeasurement& measurement, const model::Pose& X_BC,
                               PoseHypotheses& hypotheses) noexcept;

// Takes in a view of a flat target. What fits no hypothesis is an outlier and left out; after too many in a
// row the poses of that view are begun anew. Real-time: yes.
[[nodiscard]] Verdict TakeView(const config::PredictConfig& config, const features::Polygon& polygon,
                               const CornerView& view, PoseHypotheses& hypotheses) noexcept;

// Where the believed pose of a flat target is at `now_ns`. Of one that stands still it is the pose that fits
// all views: what is wrong with the corners is wrong in the same way for as long as the camera stands, so
// that a filter would take many views from there for much news, and forget the tilt that was seen so much
// better from aside. Where arm, camera and corners do not agree to some tenths of a pixel, nothing counts as
// still, and the filter speaks. Real-time: yes.
[[nodiscard]] FlatMotion MotionAt(const config::PredictConfig& config, const PoseHypotheses& hypotheses,
                                  std::int64_t now_ns) noexcept;

}  // namespace fovea::estimate
