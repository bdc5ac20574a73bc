// SPDX-License-Identifier: Apache-2.0
// Keeps the arm's links away from the planes and boxes that limit its hand.
//
// While the hand is clear, the elbow or the wrist can still hit the table. Against planes the barrier covers
// the last four links: forearm, wrist and hand of an arm with six or seven joints. The links before them
// cannot reach the surface that the base stands on, and are as clear of a wall as the base is. Against boxes
// it covers all links that move. There is one row for all planes together, and one for each box.
#pragma once

#include "firmware/core/barriers/arm_bodies.hpp"
#include "firmware/core/barriers/barrier.hpp"
#include "firmware/core/config/servo_config.hpp"
#include "firmware/core/model/kinematics.hpp"

namespace fovea::barriers {

inline constexpr int kOuterLinks = 4;  // of these, planes keep clear

// Number of rows: the planes', if there are any, then each box's.
[[nodiscard]] inline int CountLinkRows(const config::Obstacles& obstacles) noexcept {
  return (obstacles.num_planes > 0 ? 1 : 0) + obstacles.num_boxes;
}

// The smallest distance of these links from the planes or the box of row `i` [m], 0 <= i < CountLinkRows.
// That from a box is at most `enough`: links that are further away cost little. Real-time: yes.
[[nodiscard]] double ClearanceOfLinks(const config::Obstacles& obstacles, int i, const ArmBodies& bodies,
                                      double enough) noexcept;

// The barrier that keeps the distance of row `i` above guard.link_clearance [m] plus twice the workspace
// margin. The links approach no faster than they can stop. A link that is already nearer must not come nearer
// still. Real-time: yes.
[[nodiscard]] Barrier LinksBarrier(const config::ServoConfig& config, int i, const model::ArmPoses& poses,
                                   const ArmBodies& bodies) noexcept;

}  // namespace fovea::barriers
