// SPDX-License-Identifier: Apache-2.0
// The rendered camera of a run: several renderers, each with its own thread, and the sensor.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/camera/optics.hpp"
#include "sim/camera/sim_camera.hpp"
#include "sim/faults/picture_faults.hpp"
#include "sim/faults/shared_faults.hpp"
#include "sim/run/trace.hpp"
#include "sim/scenario/run_description.hpp"

namespace fovea::sim {

// Number of pictures that are drawn at the same time. Pictures do not depend on it.
inline constexpr int kRenderers = 2;

class Eye {
 public:
  // `about` and `trace` (may be null) must outlive it. `queue`: see SimCameraConfig. InputError,
  // std::runtime_error: this computer cannot draw it.
  Eye(const RunDescription& about, std::size_t queue, RunTrace* trace = nullptr, int renderers = kRenderers);

  // Changes the faults of all pictures that are not drawn yet. From any thread.
  void SetFaults(const PictureFaults& faults) { faults_.Set(faults); }

  [[nodiscard]] SimCamera& camera() { return *camera_; }
  [[nodiscard]] const SimCamera& camera() const { return *camera_; }
  [[nodiscard]] const std::string& driver_name() const { return optics_.front()->driver_name(); }

 private:
  SharedFaults<PictureFaults> faults_;
  const int width_px_;
  std::vector<std::unique_ptr<Optics>> optics_;
  std::unique_ptr<SimCamera> camera_;  // its threads use the optics
};

}  // namespace fovea::sim
