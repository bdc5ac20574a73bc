// One list of fields for each struct of settings: its key, unit, range and meaning stand once, beside the
// struct.
//
//   template <class Visitor, Struct<MoveConfig> Config>
//   void Fields(Visitor& v, Config& c) {
//     v.Number({"servo.move_speed", "m/s", "..."}, c.speed, 0.001, 10.0);
//   }
//
// Keys and their documents, the checks of ServoTask::Init, the line to a board and the log all follow from
// it. A visitor has these, with `value` const or not:
//
//   Flag(field, bool& value)
//   Number(field, double& value, min, max)
//   Integer(field, int& value, min, max)
//   Choice(field, enum& value, names)
//   PerJoint(field, JointArray& value, min, max)   one number for each joint; a key that may be left out
//   Derived(field, value, min, max)                a number, a fixed matrix or a flag that follows from a key
//                                                  of that name, which has other units or another shape
//   Count(field, int& value, most)                 of what follows: 0 to `most`
//
// The order is that of the line and of logs: a field that is added stands at the end of its struct's list, so
// that logs stay readable that were written without it. tests/core/config proves that no field is missing.
#pragma once

#include <concepts>
#include <type_traits>

namespace fovea::config {

struct Field {
  const char* key;           // dotted
  const char* unit = "";     // "" when it has none
  const char* meaning = "";  // for people; "" where other text explains the key
};

template <class T, class S>
concept Struct = std::same_as<std::remove_const_t<T>, S>;

}  // namespace fovea::config
