// SPDX-License-Identifier: Apache-2.0
// The fields of a target's feature. They follow from the keys of [target] and from servo.feature and
// servo.goal, which have their own texts (firmware/host/config).
#pragma once

#include "firmware/core/config/fields.hpp"
#include "firmware/core/features/target_feature.hpp"

namespace fovea::config {

template <class Visitor, Struct<features::TargetFeature> Feature>
void Fields(Visitor& v, Feature& f) noexcept {
  v.Choice({"target.kind"}, f.target, features::kTargetNames);
  v.Choice({"servo.feature"}, f.form, features::kFormNames);
  v.Flag({"servo.hold_orientation"}, f.hold_orientation);
  v.Derived({"target.diameter"}, f.radius, 1e-4, 10.0);
  v.Derived({"target.side"}, f.side, 1e-4, 100.0);
  v.Count({"target.kind"}, f.corners.num_corners, features::Polygon::kMost);
  for (auto& corner : f.corners.corners) {
    v.Derived({"target.side"}, corner, -1e3, 1e3);
  }
  v.Derived({"servo.goal"}, f.p_CO_C_star, -100.0, 100.0);
  v.Derived({"servo.goal_rpy_deg"}, f.R_CO_star, -1.0, 1.0);
}

}  // namespace fovea::config
