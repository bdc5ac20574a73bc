// SPDX-License-Identifier: Apache-2.0
// Stage 1, predict: computes where the target is now from measurements that arrive late.
//
// A measurement is valid at its stamp. It is transformed to the base frame with the camera's pose of that
// time (from the joints' history), filtered there, and predicted to the present with the target's velocity.
#pragma once

#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/estimate/eye_watch.hpp"
#include "firmware/core/estimate/joint_history.hpp"
#include "firmware/core/estimate/pose_hypotheses.hpp"
#include "firmware/core/estimate/stamp_error.hpp"
#include "firmware/core/estimate/stuck_picture.hpp"
#include "firmware/core/estimate/target_filter.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::estimate {

// What is known of the target.
enum class Knowledge : std::uint8_t {
  kNone,       // no measurement was accepted
  kTooLittle,  // too few were accepted
  kKnown,
  kBegunAnew,  // the filter restarted and has too few; the last belief continues, as for a hidden target
};
inline constexpr int kNumKnowledge = 4;

// The estimate of the target when its filter restarted.
struct LastBelief {
  std::int64_t stamp_ns = 0;
  FlatMotion motion;  // at that stamp
};

struct PredictState {
  JointHistory history;
  StuckPicture picture;
  TargetFilter filter;        // of sphere and circle
  PoseHypotheses hypotheses;  // of circle, square and triangle
  Knowledge knowledge = Knowledge::kNone;
  LastBelief belief;                   // for kBegunAnew
  std::int64_t accepted_stamp_ns = 0;  // of the last measurement in the present estimate
  LearntLateness lateness;             // of the camera
  // The last measurement itself, for servo.predict = false.
  model::Pose X_CO_meas;

  // Forgets the target. Keeps the history of arm and camera, and the lateness.
  void Reset() noexcept {
    filter = TargetFilter{};
    hypotheses = PoseHypotheses{};
    knowledge = Knowledge::kNone;
    belief = LastBelief{};
  }
};

struct Prediction {
  bool known = false;                          // there were enough measurements
  std::int64_t age_ns = 0;                     // now less the last accepted stamp; only if one was accepted
  model::Vec3 p_BO = model::Vec3::Zero();      // now [m]
  model::Mat3 R_BO = model::Mat3::Identity();  // now; of a target whose orientation is seen
  model::Vec3 v_BO = model::Vec3::Zero();      // [m/s]
  StampError late;                             // of the camera
  features::TargetInCamera seen;               // now: pose and twist in axes of C
};

// Processes `measurement` and returns what was done with it. `eye` watches it, too. Real-time: yes.
[[nodiscard]] hal::Intake TakeMeasurement(const config::ServoConfig& config, std::int64_t now_ns,
                                          const hal::FeatureMeasurement& measurement, PredictState& state,
                                          EyeWatch& eye) noexcept;

// The target at `now_ns`, seen from the present camera pose `X_BC`. Real-time: yes.
[[nodiscard]] Prediction Predict(const config::ServoConfig& config, std::int64_t now_ns,
                                 const model::Pose& X_BC, const PredictState& state) noexcept;

}  // namespace fovea::estimate
