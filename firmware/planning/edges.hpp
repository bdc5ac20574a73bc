// SPDX-License-Identifier: Apache-2.0
// Whether the arm can move straight from one posture to another, and one step on the way to a posture.
#pragma once

#include "firmware/planning/posture_space.hpp"

namespace fovea::planning {

// Postures that are further apart are tested between, too [rad]. This suffices for a search. The motion at
// its end is proved (motion_proof.hpp).
inline constexpr double kEdgeResolution = 0.1;
inline constexpr double kStep = 0.2;  // of a tree [rad]

// True if all tested postures from `from`, itself not tested, to `to` are free.
[[nodiscard]] bool IsEdgeFree(const PostureSpace& space, const model::VecN& from, const model::VecN& to,
                              Work& work) noexcept;

enum class Progress : std::uint8_t { kThere, kNearer, kBarred };

// One step from `from` towards `to`, with the camera turned so that the target stays in the picture. `q`
// becomes the posture reached, unless barred.
[[nodiscard]] Progress StepTowards(const PostureSpace& space, const model::VecN& from, const model::VecN& to,
                                   Work& work, model::VecN& q) noexcept;

}  // namespace fovea::planning
