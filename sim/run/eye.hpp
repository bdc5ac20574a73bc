// SPDX-License-Identifier: Apache-2.0
// The rendered camera of a run: several renderers, each with its own thread, and the sensor.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sim/camera/exposed_camera.hpp"
#include "sim/camera/optics.hpp"
#include "sim/faults/picture_faults.hpp"
#include "sim/faults/shared_faults.hpp"
#include "sim/run/trace.hpp"
#include "sim/scenario/run_description.hpp"

namespace fovea::sim {

// Number of pictures that are drawn at the same time. Pictures do not depend on it.
inline constexpr int kRenderers = 2;

struct EyeOptions {
  std::size_t queue = 2;         // see SimCameraConfig
  RunTrace* trace = nullptr;     // may be null; must outlive the eye
  int renderers = kRenderers;    // pictures that are drawn at the same time
  RendererPool* pool = nullptr;  // see Optics; may be null; must outlive the eye
  // Nobody but vision looks at the pictures: it has what it looks at drawn, by one renderer. Not with a
  // trace, and not with a camera that needs whole pictures: one with automatic exposure or a mosaic.
  bool for_vision_only = false;
};

class Eye {
 public:
  // `about` must outlive it. InputError, std::runtime_error: this computer cannot draw it.
  Eye(const RunDescription& about, const EyeOptions& options);

  // Changes the faults of all pictures that are not drawn yet. From any thread.
  void SetFaults(const PictureFaults& faults) { faults_.Set(faults); }

  [[nodiscard]] ExposedCamera& camera() { return *camera_; }
  [[nodiscard]] const ExposedCamera& camera() const { return *camera_; }
  [[nodiscard]] const std::string& driver_name() const { return optics_.front()->driver_name(); }

 private:
  void Draw(Optics& optics, const Exposure& exposure, std::span<const PictureArea> areas,
            std::span<std::uint8_t> rgba);

  SharedFaults<PictureFaults> faults_;
  const int width_px_;
  std::vector<std::unique_ptr<Optics>> optics_;
  std::unique_ptr<ExposedCamera> camera_;  // its threads use the optics
};

}  // namespace fovea::sim
