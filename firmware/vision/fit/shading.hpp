// SPDX-License-Identifier: Apache-2.0
// How far a ball's surface is turned towards the camera near its outline.
#pragma once

namespace fovea::vision {

// The component of the surface's normal towards the camera, at `d_px` inside an outline of radius r:
// sqrt(2 d / r - d^2 / r^2), which is 1 in the middle.
[[nodiscard]] double SurfaceTurn(double d_px, double radius_px);
// Its mean over the part of the pixel from d - 0.5 to d + 0.5 that is inside the outline.
[[nodiscard]] double MeanSurfaceTurn(double d_px, double radius_px);

}  // namespace fovea::vision
