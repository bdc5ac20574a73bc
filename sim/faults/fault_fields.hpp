// SPDX-License-Identifier: Apache-2.0
// Each struct of faults has one list of its keys, beside the struct:
//
//   template <class Visitor, Struct<PictureFaults> Faults>
//   void Fields(Visitor& v, Faults& f) {
//     v.Window({"mirror", "s", "the camera's pictures are mirrored, left is right"}, f.mirror);
//   }
//
// The keys of [faults], their checks, the list of a run's faults and the refusals of `serve` come from this
// list (sim/scenario/fault_settings.cpp). The numbers that size a fault follow its window. A visitor has the
// functions below; `value` may be const. A field's key omits "faults.":
//
//   Window(field, window, not_served)       a fault; its key is faults.<name>_s. `not_served`: the reason why
//                                           `serve` refuses it, null if `serve` has it
//   Number(field, double& value, min, max)
//   Scaled(field, value, unit, min, max)    a number in the key's unit; `value` is `unit` times this number
//   Flag(field, bool& value)
//   Joint(field, int& value, window, least) counted from 1 in the key and from 0 in `value`; `least` 0: key 0
//                                           is kAllJoints. Checked if `window` begins
//   List(field, values, most, min, max)     1 to `most` numbers
//   Numbers(field, min, max, double&...)    one number per reference
//   Size(field, double value)               must be above 0; adds no key
#pragma once

#include <concepts>
#include <type_traits>

#include "sim/faults/time_window.hpp"

namespace fovea::sim {

struct FaultField {
  const char* key;
  const char* unit = "";     // "" if it has none
  const char* meaning = "";  // help text of the key; "" if another entry explains it
};

template <class T, class S>
concept Struct = std::same_as<std::remove_const_t<T>, S>;

inline constexpr int kAllJoints = -1;

inline constexpr double kNsOfMs = 1e6;
inline constexpr double kNsOfS = 1e9;

}  // namespace fovea::sim
