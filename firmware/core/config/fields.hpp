// SPDX-License-Identifier: Apache-2.0
// One list of fields for each settings struct. Key, unit, range and meaning stand once, beside the struct.
//
//   template <class Visitor, Struct<MoveConfig> Config>
//   void Fields(Visitor& v, Config& c) {
//     v.Number({"servo.move_speed", "m/s", "..."}, c.speed, 0.001, 10.0);
//   }
//
// The list generates the keys and their documentation, the checks of ServoTask::Init, the messages to a board
// and the log. A visitor has these functions, with `value` const or not:
//
//   Flag(field, bool& value)
//   Number(field, double& value, min, max)
//   Integer(field, int& value, min, max)
//   Choice(field, enum& value, names)
//   PerJoint(field, JointArray& value, min, max)   one number for each joint; the key is optional
//   Derived(field, value, min, max)                a number, a fixed matrix or a flag computed from the key
//                                                  of that name, whose unit or shape differs
//   Count(field, int& value, most)                 number of entries that follow: 0 to `most`
//
// Keys that may change while the arm moves have a number, kInMotion<N> as the field's fourth entry
// (tuning.hpp).
//
// Messages and logs use this order. Add a new field at the end of its struct's list: older logs then stay
// readable. tests/core/config proves that no field is missing.
#pragma once

#include <concepts>
#include <type_traits>

namespace fovea::config {

inline constexpr int kFixed = -1;        // the key does not change after Init
inline constexpr int kMostTunable = 16;  // keys that may change in motion

// The number of a key that may change in motion. It stands in messages and logs: never change it, and never
// give it to another key. tests/core/config proves that no number occurs twice.
template <int kNumber>
requires(kNumber >= 0 && kNumber < kMostTunable) inline constexpr int kInMotion = kNumber;

struct Field {
  const char* key;           // dotted
  const char* unit = "";     // "" when it has none
  const char* meaning = "";  // for people; "" if the key is explained elsewhere
  int in_motion = kFixed;    // or the number under which it may change in motion
};

template <class T, class S>
concept Struct = std::same_as<std::remove_const_t<T>, S>;

}  // namespace fovea::config
