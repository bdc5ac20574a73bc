// SPDX-License-Identifier: Apache-2.0
// The space that an arm fills, from its description: capsules, and the pairs of them that could touch.
#pragma once

#include <optional>
#include <vector>

#include "firmware/core/model/arm_model.hpp"

namespace fovea::robots {

// The capsule that encloses a simple body of a description, in the link's frame. For a box it lies along the
// longest side.
[[nodiscard]] model::Capsule CapsuleOfCylinder(const model::Pose& X_LS, double length, double radius);
[[nodiscard]] model::Capsule CapsuleOfBox(const model::Pose& X_LS, const model::Vec3& size);

// One capsule that encloses all of `parts`, at least one: a single part itself, else a capsule about the line
// between the two ends that are farthest apart.
[[nodiscard]] model::Capsule Hold(const std::vector<model::Capsule>& parts);

// Fills `arm.shape`. `parts`: the simple bodies of the base, in B, and of each link [num_joints + 1]. A link
// without simple bodies, or with only meshes, gets a capsule from its joint to the next.
//
// Candidates are pairs of bodies with more than ArmShape::kNeighbours joints between them. A pair could touch
// if it comes near in some of many random postures, but not if it is near in many of them, like the parts of
// a wrist. The postures are always the same.
void SetShape(const std::vector<std::vector<model::Capsule>>& parts, model::ArmModel& arm);

}  // namespace fovea::robots
