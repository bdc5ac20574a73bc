// SPDX-License-Identifier: Apache-2.0
// The timeline of a run's threads.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "firmware/host/recording/trace/trace.hpp"
#include "sim/camera/optics.hpp"
#include "sim/camera/sim_camera.hpp"

namespace fovea::sim {

class RunTrace {
 public:
  // Reserves space for a run of `duration_s` with this many renderers. InputError: `file` cannot be written.
  RunTrace(std::filesystem::path file, double duration_s, double camera_rate_hz, int renderers);

  [[nodiscard]] trace::Track& servo() { return *servo_; }
  [[nodiscard]] trace::Track& vision() { return *vision_; }
  // Wraps `painter`. Records each picture, its parts and the sensor's work on the renderer's own track.
  [[nodiscard]] Painter Watched(Painter painter, Optics& optics, int renderer);

  // Call it after all threads have ended. Returns why the file cannot be written; "" if it was.
  [[nodiscard]] std::string Write() const;

 private:
  std::filesystem::path file_;
  trace::Trace trace_{"fovea-sim"};
  trace::Track* servo_;
  trace::Track* vision_;
  std::vector<trace::Track*> renderers_;
};

}  // namespace fovea::sim
