// SPDX-License-Identifier: Apache-2.0
// A triangle by its three corners: polygon.hpp, dim 6, controls all six degrees of freedom.
//
// L_s loses rank when the camera's centre lies on the cylinder through the three corners with its axis along
// the triangle's normal (Michel and Rives, Singularities in the determination of the situation of a robot
// effector from the perspective view of three points, 1993). Three points look the same from up to four
// camera poses; near the goal the law converges to the nearest.
#pragma once

#include "firmware/core/features/polygon.hpp"

namespace fovea::features {

// Three corners in the plane z = 0 [m], x and y of each, with any origin and order. The result has their mean
// as origin and the order that turns from x to y.
[[nodiscard]] Polygon MakeTriangle(const std::array<double, 6>& corners) noexcept;

// The default: sides of 0.12, 0.10 and 0.08 m, all different, so that no turn can be mistaken for another.
inline constexpr std::array<double, 6> kDefaultTriangle{-0.060, 0.022, 0.060, 0.022, -0.015, -0.044};

// The distance of the camera's centre from that cylinder [m]: positive outside, negative inside. NaN if the
// corners lie on a line. Real-time: yes.
[[nodiscard]] double FromSingularCylinder(const Polygon& triangle, const model::Pose& X_CO) noexcept;

}  // namespace fovea::features
