// A ball's surface turns away towards its outline.
#pragma once

namespace fovea::vision {

// The part of the surface's normal that looks at the camera, `d_px` inside an outline of radius r: 1 in the
// middle, sqrt(2 d / r - d^2 / r^2).
[[nodiscard]] double SurfaceTurn(double d_px, double radius_px);
// Its mean over the part of a pixel, from d - 0.5 to d + 0.5, that is inside.
[[nodiscard]] double MeanSurfaceTurn(double d_px, double radius_px);

}  // namespace fovea::vision
