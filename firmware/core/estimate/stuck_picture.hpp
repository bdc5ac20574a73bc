// Whether the picture moves as the hand does. A camera that repeats one picture shows a target that seems to
// be carried along with the hand; taken for a measurement, its motion would be fed forward and drive the hand
// on for ever.
//
// The vision task says for how long the picture has been the same. The arm's encoders say where the camera
// went meanwhile, and so by how much a scene that stands still had to shift in the picture. Where that is
// more than a shift that nobody overlooks, one of two things is true: the target stands still in B and the
// picture should have changed, or it stands still in C. What the measurement is nearer to decides.
//
// A target that the hand follows without an error, before a ground without any texture, looks stuck too, and
// is taken for it: the arm then stops, and the target moves in the picture again.
#pragma once

#include <cstdint>

#include "firmware/core/model/types.hpp"

namespace fovea::estimate {

// The first measurement since which the picture has been the same.
struct StuckPicture {
  bool started = false;
  std::int64_t since_ns = 0;
  model::Pose X_BC;
  model::Vec3 p_CO_C = model::Vec3::Zero();  // as it was measured then [m]
};

struct PictureView {
  std::int64_t since_ns = 0;  // the picture has been the same since then; the measurement's stamp: it changed
  model::Pose X_BC_since;     // the camera's pose then
  model::Pose X_BC;           // at the measurement's stamp
  model::Vec3 p_CO_C;         // the target as measured [m]
};

// Whether the picture is stuck, by `view` and what was before. `stuck_shift`: in the normalised image.
// Real-time: yes.
[[nodiscard]] bool IsStuck(double stuck_shift, const PictureView& view, StuckPicture& picture) noexcept;

}  // namespace fovea::estimate
