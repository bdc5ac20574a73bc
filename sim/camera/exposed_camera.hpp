// SPDX-License-Identifier: Apache-2.0
// A simulated camera: the world exposes it, vision acquires its frames.
#pragma once

#include <cstdint>
#include <string>

#include "fovea/hal/camera.hpp"
#include "sim/render/exposure.hpp"

namespace fovea::sim {

class ExposedCamera : public hal::Camera {
 public:
  virtual ~ExposedCamera() = default;

  // Called by the simulation's thread.
  virtual void Expose(Exposure exposure) = 0;
  // Announces that no exposure will follow. Waiting exposures are still delivered; then Acquire returns
  // kClosed. Called by any thread.
  virtual void Close() = 0;

  // Exposures that were dropped because too many waited.
  [[nodiscard]] virtual std::uint64_t lost() const = 0;
  // Reason for the camera's device fault; "" if there is none.
  [[nodiscard]] virtual std::string fault() const = 0;
};

}  // namespace fovea::sim
