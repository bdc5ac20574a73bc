// Which of the poses that a flat target's corners allow is the true one.
//
// One image of three corners allows up to four poses, each exactly. But the camera moves, its poses are
// known, and in the base frame the true pose of a target that lies still is one and the same from everywhere
// (still_pose.hpp), while the others seem to turn as the camera goes. So every pose of the first image begins
// a branch. The one that fits best is believed; the others are given up once they fit so much worse that
// chance cannot explain it. When none stands still, how smoothly each moves by its own filter
// (pose_filter.hpp) speaks instead.
#pragma once

#include "firmware/core/estimate/pose_filter.hpp"
#include "firmware/core/estimate/still_pose.hpp"
#include "fovea/hal/events.hpp"

namespace fovea::estimate {

struct PoseChoice {
  struct Branch {
    PoseFilter filter;
    model::Pose X_BO_still;
    double misfit = 0.0;        // sum of the filter's squared innovations, in standard deviations
    double still_misfit = 0.0;  // of the still pose from all views, the same
  };

  int num_branches = 0;  // 0: nothing is known; more than 1: the image's poses are not told apart yet
  int believed = 0;
  int accepted = 0;  // views since the start, up to accepted_min
  int rejected_in_row = 0;
  std::int64_t stamp_ns = 0;  // of the last view that was taken in
  bool is_still = false;      // the last view and those from elsewhere fit one pose
  StillViews views;
  std::array<Branch, hal::kMaxPoses> branches;

  [[nodiscard]] const PoseFilter& best() const noexcept {
    return branches[static_cast<std::size_t>(believed)].filter;
  }
};

// Takes in a view. What fits no branch is an outlier and left out; after too many in a row the poses of that
// view are begun anew. Real-time: yes.
[[nodiscard]] hal::Intake UpdatePoses(const config::PredictConfig& config, const features::Polygon& polygon,
                                      const CornerView& view, PoseChoice& choice) noexcept;

// Where the believed pose is `now_ns`. Of a target that stands still it is the pose that fits all views: what
// is wrong with the corners is wrong in the same way for as long as the camera stands, so that a filter would
// take many views from there for much news, and forget the tilt that was seen so much better from aside.
// Where arm, camera and corners do not agree to some tenths of a pixel, nothing counts as still, and the
// filter speaks. Real-time: yes.
[[nodiscard]] FlatMotion MotionAt(const config::PredictConfig& config, const PoseChoice& choice,
                                  std::int64_t now_ns) noexcept;

}  // namespace fovea::estimate
