// SPDX-License-Identifier: Apache-2.0
// Where a still target must be seen by an arm whose calibration is wrong, and how that depends on each error
// (THEORY H).
//
// The unknowns, in their order: how much older than their stamps the pictures are [s]; the mount's error as a
// twist of C [m, rad]; relative errors of the focal length and of the target's size; the encoders' zeros
// [rad] but those of the first and the last joint, which turn target and mount alone; the target's pose in B
// as a twist of O, of which a ball or disc has only the place.
#pragma once

#include "firmware/core/config/servo_config.hpp"
#include "firmware/host/beliefs/joint_track.hpp"
#include "firmware/host/beliefs/least_squares.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::beliefs {

struct EyeLayout {
  static constexpr int kLate = 0;
  static constexpr int kShift = 1;  // of the mount, x, y, z
  static constexpr int kTurn = 4;
  static constexpr int kFocal = 7;
  static constexpr int kSize = 8;
  static constexpr int kZeros = 9;

  explicit EyeLayout(const config::ServoConfig& config)
      : zeros(config.arm.num_joints > 2 ? config.arm.num_joints - 2 : 0),
        is_flat(config.feature.SeesOrientation()) {}

  int zeros = 0;  // number of them
  bool is_flat = false;
  [[nodiscard]] int target() const { return kZeros + zeros; }
  [[nodiscard]] int size() const { return target() + (is_flat ? 6 : 3); }
};

struct EyeState {
  double late = 0.0;
  model::Pose X_EC;
  double focal = 0.0;
  double size = 0.0;
  model::VecN zeros;  // [num_joints] readings at angle 0; 0 for the first and the last
  model::Pose X_BO;
};

// The believed state of a target at `X_BO`.
[[nodiscard]] EyeState Believed(const config::ServoConfig& config, const model::Pose& X_BO);

// Adds `change` in the order of EyeLayout.
void Apply(const EyeLayout& layout, const Eigen::VectorXd& change, EyeState& state);

// The camera's pose at a picture's stamp, and how it moves with all joints, V_BC_C = J_C dq.
struct EyePose {
  model::Pose X_BC;
  model::Mat6N J_C;
  model::Vec6 V_BC_C;
};
[[nodiscard]] bool PoseOfEye(const config::ServoConfig& config, const JointTrack& track,
                             const EyeState& state, std::int64_t stamp_ns, EyePose& pose);

// Measured less expected, in standard deviations. For a square or triangle, `turn` is the index of the
// measured corner that is O's first. False if the track does not reach there, or the target would be behind
// the camera.
[[nodiscard]] bool Compare(const config::ServoConfig& config, const JointTrack& track,
                           const hal::FeatureMeasurement& measurement, int turn, const EyeState& state,
                           Equations& equations);

}  // namespace fovea::beliefs
