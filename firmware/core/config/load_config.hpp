// SPDX-License-Identifier: Apache-2.0
// [servo] what the hand carries, as far as it may change in motion. The load itself is part of the arm's
// model.
#pragma once

#include "firmware/core/config/fields.hpp"
#include "firmware/core/model/load.hpp"

namespace fovea::config {

inline constexpr int kLoadOffsetKey = 14;  // number of servo.load_offset, for servo.learn

struct LoadConfig {
  double offset = 0.0;                       // [kg]
  double mass = 0.0;                         // of the load that is part of the arm's model [kg]
  model::Vec3 p_ECom = model::Vec3::Zero();  // its centre [m]
};

// No load weighs less than nothing. Init checks it, and so does each change in motion.
inline bool IsPossible(const LoadConfig& c) noexcept { return c.mass + c.offset >= 0.0; }

inline model::PointMass OffsetOf(const LoadConfig& c) noexcept { return {c.offset, c.p_ECom}; }

template <class Visitor, Struct<LoadConfig> Config>
void Fields(Visitor& v, Config& c) noexcept {
  v.Number(
      {"servo.load_offset", "kg",
       "the load is this much heavier than arm.load_mass, which the robot knows: the servo alone carries "
       "the difference, as a point mass at arm.load_com",
       kInMotion<kLoadOffsetKey>},
      c.offset, -1.0, 1.0);
  v.Derived({"arm.load_mass"}, c.mass, 0.0, 100.0);
  v.Derived({"arm.load_com"}, c.p_ECom, -2.0, 2.0);
}

}  // namespace fovea::config
