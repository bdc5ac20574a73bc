// What a robot's description says of the space that its arm fills: capsules, and which of them could touch.
#pragma once

#include <optional>
#include <vector>

#include "firmware/core/model/arm_model.hpp"

namespace fovea::robots {

// A simple body of a description, placed in its link's frame: a cylinder or a ball as the capsule that holds
// it, a box as the one along its longest side.
[[nodiscard]] model::Capsule CapsuleOfCylinder(const model::Pose& X_LS, double length, double radius);
[[nodiscard]] model::Capsule CapsuleOfBox(const model::Pose& X_LS, const model::Vec3& size);

// One capsule that holds all of `parts`, at least one: itself where it is alone, else about the line between
// the two ends that are furthest apart.
[[nodiscard]] model::Capsule Hold(const std::vector<model::Capsule>& parts);

// Fills `arm.shape`. `parts`: the simple bodies of the base, in B, and of each link [num_joints + 1]. A link
// of which a description has none, or meshes alone, gets a capsule from its joint to the next.
//
// A pair of bodies with more than ArmShape::kNeighbours joints between them could touch when it comes near in
// some of many random postures; not when it is near in many of them, as the parts of a wrist that are built
// that way. The postures are always the same ones.
void SetShape(const std::vector<std::vector<model::Capsule>>& parts, model::ArmModel& arm);

}  // namespace fovea::robots
