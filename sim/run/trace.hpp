// The timeline of a run: which thread did what, when.
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
  // With room for a run of `duration_s` and the pictures of so many renderers. InputError when `file` cannot
  // be written.
  RunTrace(std::filesystem::path file, double duration_s, double camera_rate_hz, int renderers);

  [[nodiscard]] trace::Track& servo() { return *servo_; }
  [[nodiscard]] trace::Track& vision() { return *vision_; }
  // A painter that does what `painter` does; each picture, its parts and the sensor stand on a track of its
  // own.
  [[nodiscard]] Painter Watched(Painter painter, Optics& optics, int renderer);

  // When all threads are done. std::runtime_error as Trace::Write.
  void Write() const { trace_.Write(file_); }

 private:
  std::filesystem::path file_;
  trace::Trace trace_{"fovea-sim"};
  trace::Track* servo_;
  trace::Track* vision_;
  std::vector<trace::Track*> renderers_;
};

}  // namespace fovea::sim
