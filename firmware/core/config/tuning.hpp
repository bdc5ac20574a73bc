// SPDX-License-Identifier: Apache-2.0
// Keys that change while the arm moves: the request for it, and a visitor of their fields.
//
// Only keys above the guard are among them: gains of the visual law and of the target's filter, and the ages
// of a measurement. The guard proves for each reference that the arm can stop, whatever motion the law
// wishes, so no value of these keys weakens the proof. The filter's state stays valid, because these keys are
// no part of it. One more changes: servo.load_offset, below the guard. It is bounded, its ramp keeps the
// torque smooth, and the better the model knows the load, the better the arm follows the reference that is
// proved. All other keys stay fixed:
//   - limits ([safety]): the proof holds only while the limits last. After a limit shrinks, the present
//   motion
//     may be outside it, and no stop is proved.
//   - the motion law: the proof assumes that the arm follows its reference. Changed gains move the torque at
//     once, and Init checks them against the arm.
//   - commanded motions: their path is planned when they begin.
//   - counts, choices and properties of target and camera, which do not change or cannot be ramped.
#pragma once

#include <cstdint>

#include "firmware/core/config/fields.hpp"

namespace fovea::config {

// A request to change a key in motion.
struct Tuning {
  static constexpr std::int32_t kNone = -1;
  std::int32_t key = kNone;  // the key's number (kInMotion)
  double value = 0.0;        // in the key's unit
  [[nodiscard]] bool IsAsked() const noexcept { return key != kNone; }
};

// A visitor of the field lists that calls `visit(field, value, min, max)` for keys that may change in motion.
template <class Visit>
class TunableFields {
 public:
  explicit TunableFields(const Visit& visit) noexcept : visit_(visit) {}

  template <class T>
  void Number(const Field& field, T& value, double min, double max) noexcept {
    if (field.in_motion != kFixed) {
      visit_(field, value, min, max);
    }
  }
  template <class... Args>
  void Flag(const Field& /*field*/, const Args&... /*args*/) noexcept {}
  template <class... Args>
  void Integer(const Field& /*field*/, const Args&... /*args*/) noexcept {}
  template <class... Args>
  void Choice(const Field& /*field*/, const Args&... /*args*/) noexcept {}
  template <class... Args>
  void PerJoint(const Field& /*field*/, const Args&... /*args*/) noexcept {}
  template <class... Args>
  void Derived(const Field& /*field*/, const Args&... /*args*/) noexcept {}
  template <class... Args>
  void Count(const Field& /*field*/, const Args&... /*args*/) noexcept {}

 private:
  const Visit& visit_;
};

// Calls `visit(field, value, min, max)` for each key of `config`, a settings struct, that may change in
// motion, in the order of the lists. Real-time: yes, if `visit` is.
template <class Config, class Visit>
void EachTunable(Config& config, const Visit& visit) noexcept {
  TunableFields<Visit> visitor(visit);
  Fields(visitor, config);
}

}  // namespace fovea::config
