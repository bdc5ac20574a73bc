// Stage 1, predict: from measurements that are old when they come to where the target is now.
//
// A measurement is true at its stamp. It is lifted to the base frame with the camera's pose of that moment
// (the joints' history knows it), filtered there, and taken to the present by the target's own velocity.
#pragma once

#include <cstdint>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/estimate/eye_watch.hpp"
#include "firmware/core/estimate/joint_history.hpp"
#include "firmware/core/estimate/pose_hypotheses.hpp"
#include "firmware/core/estimate/stuck_picture.hpp"
#include "firmware/core/estimate/target_filter.hpp"
#include "firmware/core/model/kinematics.hpp"
#include "fovea/hal/feature.hpp"

namespace fovea::estimate {

// What measurements say of the target so far.
enum class Knowledge : std::uint8_t {
  kNone,       // none was taken
  kTooLittle,  // too few were
  kKnown,
  kBegunAnew,  // the filter had to start anew and has too few; what was believed before goes on till then,
               // as it does while the target is hidden
};
inline constexpr int kNumKnowledge = 4;

// What was believed of the target when its filter had to start anew.
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
  LastBelief belief;                   // of kBegunAnew
  std::int64_t accepted_stamp_ns = 0;  // of the last measurement that went into what is believed
  // The last measurement itself, for servo.predict = false.
  model::Pose X_CO_meas;

  // Forgets the target; what is known of arm and camera stays.
  void Reset() noexcept {
    filter = TargetFilter{};
    hypotheses = PoseHypotheses{};
    knowledge = Knowledge::kNone;
    belief = LastBelief{};
  }
};

struct Prediction {
  bool known = false;                          // enough measurements to say where the target is
  std::int64_t age_ns = 0;                     // now less the last accepted stamp; only when one was accepted
  model::Vec3 p_BO = model::Vec3::Zero();      // now [m]
  model::Mat3 R_BO = model::Mat3::Identity();  // now; of a target whose orientation is seen
  model::Vec3 v_BO = model::Vec3::Zero();      // [m/s]
  features::TargetInCamera seen;               // now: pose and twist in axes of C
};

// Takes in `measurement`, and says what became of it; `eye` watches it, too. Real-time: yes.
[[nodiscard]] hal::Intake TakeMeasurement(const config::ServoConfig& config, std::int64_t now_ns,
                                          const hal::FeatureMeasurement& measurement, PredictState& state,
                                          EyeWatch& eye) noexcept;

// Where the target is at `now_ns`, seen from today's camera pose `X_BC`. Real-time: yes.
[[nodiscard]] Prediction Predict(const config::ServoConfig& config, std::int64_t now_ns,
                                 const model::Pose& X_BC, const PredictState& state) noexcept;

}  // namespace fovea::estimate
