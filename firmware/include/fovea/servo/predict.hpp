// Stage 1, predict: from measurements that are old when they come to where the target is now.
//
// A measurement is true at its stamp. It is lifted to the base frame with the camera's pose of that moment
// (the joints' history knows it), filtered there, and taken to the present by the target's own velocity.
#pragma once

#include <array>
#include <cstdint>

#include "fovea/hal/feature.hpp"
#include "fovea/model/kinematics.hpp"
#include "fovea/servo/disc_choice.hpp"
#include "fovea/servo/pose_choice.hpp"
#include "fovea/servo/servo_config.hpp"
#include "fovea/servo/target_filter.hpp"

namespace fovea::servo {

// Joint positions of the last half second, one entry per tick.
class JointHistory {
 public:
  static constexpr int kCapacity = 512;

  void Push(std::int64_t stamp_ns, const model::VecN& q) noexcept;

  // q at `stamp_ns`, interpolated between the two ticks around it. False when the history does not reach
  // back so far; a stamp after the newest entry gives the newest. Real-time: yes, at most 9 steps of search.
  [[nodiscard]] bool At(std::int64_t stamp_ns, model::VecN& q) const noexcept;

  void Clear() noexcept { size_ = 0; }

 private:
  friend struct StateAccess;  // writes and reads all of it: firmware/link/state_fields.hpp
  struct Entry {
    std::int64_t stamp_ns = 0;
    model::VecN q;
  };
  [[nodiscard]] const Entry& FromOldest(int i) const noexcept;

  std::array<Entry, kCapacity> entries_{};
  int newest_ = kCapacity - 1;
  int size_ = 0;
};

struct PredictState {
  JointHistory history;
  TargetFilter filter;  // of sphere and circle
  DiscChoice disc;      // of a circle
  PoseChoice poses;     // of square and triangle
  bool has_accepted = false;
  std::int64_t accepted_stamp_ns = 0;  // of the last measurement that went into the filter
  // The last measurement itself, for servo.predict = false.
  model::Pose X_CO_meas;

  void Reset() noexcept {
    filter = TargetFilter{};
    disc = DiscChoice{};
    poses = PoseChoice{};
    has_accepted = false;
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

// Takes in `measurement` (null: none came) and predicts for `now_ns` with today's camera pose `X_BC`.
// A measurement that names no such target, whose stamp the history does not reach, or that was not yet true
// at `now_ns` is left out. Real-time: yes.
[[nodiscard]] Prediction Predict(const ServoConfig& config, std::int64_t now_ns, const model::Pose& X_BC,
                                 const hal::FeatureMeasurement* measurement, PredictState& state) noexcept;

}  // namespace fovea::servo
