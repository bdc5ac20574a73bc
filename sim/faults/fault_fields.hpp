// One list of keys for each struct of faults: what sets them stands once, beside the struct.
//
//   template <class Visitor, Struct<PictureFaults> Faults>
//   void Fields(Visitor& v, Faults& f) {
//     v.Window({"mirror", "s", "the camera's pictures are mirrored, left is right"}, f.mirror);
//   }
//
// The keys of [faults], their checks, the list of what a run meets and what `serve` refuses all follow from
// it (sim/scenario/fault_settings.cpp). A visitor has these, with `value` const or not; a field's key is
// without its "faults.":
//
//   Window(field, window, not_served)       a fault, its name the key, which is faults.<name>_s.
//   `not_served`:
//                                           why `serve` cannot have it, null where it can
//   Number(field, double& value, min, max)
//   Scaled(field, value, unit, min, max)    a number in the key's unit; `value` is in `unit`s of it
//   Flag(field, bool& value)
//   Joint(field, int& value, window, least) counted from 1 in the key and from 0 in `value`; `least` 0: key 0
//                                           is kAllJoints. Checked where `window` begins
//   List(field, values, most, min, max)     1 to `most` numbers
//   Numbers(field, min, max, double&...)    as many numbers as there are
//   Size(field, double value)               must be above 0; adds no key
#pragma once

#include <concepts>
#include <type_traits>

#include "sim/faults/time_window.hpp"

namespace fovea::sim {

struct FaultField {
  const char* key;
  const char* unit = "";     // "" when it has none
  const char* meaning = "";  // for people; "" where other text explains the key
};

template <class T, class S>
concept Struct = std::same_as<std::remove_const_t<T>, S>;

inline constexpr int kAllJoints = -1;

inline constexpr double kNsOfMs = 1e6;
inline constexpr double kNsOfS = 1e9;

}  // namespace fovea::sim
