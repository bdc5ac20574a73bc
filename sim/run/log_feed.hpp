// Feeds a simulated run's log: what the run is about, what happens in it, and what came of it.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/vision/detect/detection.hpp"
#include "fovea/linux_rt/tick_meter.hpp"
#include "foxglove/image.pb.h"
#include "sim/scenario/run_description.hpp"
#include "sim/world/world.hpp"

namespace fovea::sim {

class LogFeed {
 public:
  // Creates the file, with all that is known before the run. `about` must outlive it; `may_drop`: at real
  // pace; `replayable`: see RunFilesConfig. std::runtime_error when it cannot.
  LogFeed(const RunDescription& about, const std::filesystem::path& path, bool may_drop, bool replayable);

  // From the thread that advances the world.
  void AddTruth(const Truth& truth);
  void AddTheory(const TheorySample& sample);
  // From the thread that empties the recorder.
  void AddRecord(const flight::FlightRecord& record);
  void AddKeyframe(const flight::Keyframe& keyframe);
  // From the vision thread. `X_CO`: where the target really was.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection, const model::Pose& X_CO);

  // When it is complete. std::runtime_error when it cannot be read.
  void AddFilm(const std::filesystem::path& film) { log_.AddFile("camera.mp4", "video/mp4", film); }

  // When all is over: how long the ticks took, and the summary; then completes the file.
  void Finish(const linux_rt::DurationHistogram& ticks, const std::string& summary_json);
  [[nodiscard]] std::uint64_t dropped() const { return log_.dropped(); }
  [[nodiscard]] bool failed() const { return log_.failed(); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  const RunDescription& about_;
  const std::filesystem::path path_;
  foxglove::ImageAnnotations goal_;  // drawn on every picture
  log::RunLog log_;
};

}  // namespace fovea::sim
