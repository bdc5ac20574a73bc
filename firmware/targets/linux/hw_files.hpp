// What a run on hardware leaves behind: log.mcap, report.html, summary.json and camera.mp4, by the libraries
// that a simulated run leaves its own with.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "firmware/core/config/servo_config.hpp"
#include "firmware/host/config/output_folder.hpp"
#include "firmware/host/film/eye_film.hpp"
#include "firmware/host/recording/flight/flight_recorder.hpp"
#include "firmware/host/recording/log/run_log.hpp"
#include "firmware/host/report/report.hpp"
#include "firmware/host/robots/robot.hpp"
#include "firmware/targets/linux/hw_config.hpp"
#include "firmware/targets/linux/hw_summary.hpp"
#include "firmware/vision/detect/detection.hpp"
#include "foxglove/image.pb.h"

namespace fovea::hw {

class HwFiles {
 public:
  // The arguments must outlive it. `duration_s`: 0 when nobody knows. InputError when nothing can be written
  // there; std::runtime_error when the report's page is not there.
  HwFiles(const std::string& out, const HwConfig& config, const robots::Robot& robot,
          const config::ServoConfig& servo, double duration_s);

  // From the thread that empties the recorder; the log begins with the first. Never waits.
  void AddRecord(const flight::FlightRecord& record);
  void AddKeyframe(const flight::Keyframe& keyframe);
  // From the vision thread. What is exposed before the log begins is left out.
  void AddFrame(const hal::Frame& frame, const vision::Detection& detection);

  // When the threads are done: completes the film, and says what was kept and what was not. A film that fails
  // is left out, and that is all.
  LogCounters EndFilm();
  // Puts everything in place. Throws what went wrong with any of it; then the folder is as it was, but for a
  // log that could not be written on: it stands there alone.
  void Write(const HwSummary& summary);

 private:
  void WriteAll(const HwSummary& summary);
  void Begin(std::int64_t start_ns);
  void KeepPicture(const hal::Frame& frame, const vision::Detection& detection);

  const HwConfig& config_;
  const robots::Robot& robot_;
  const config::ServoConfig& servo_;
  const double duration_s_;
  const report::ReportPage page_;
  config::OutputFolder folder_;
  const std::filesystem::path log_path_;
  foxglove::ImageAnnotations goal_;  // drawn on every picture
  log::RunLog log_;
  std::atomic<bool> begun_{false};
  std::int64_t start_ns_ = 0;         // of the loop's clock; set before begun_
  std::int64_t last_ns_ = 0;          // of the last record
  std::int64_t next_picture_ns_ = 0;  // of the vision thread
  std::uint64_t pictures_ = 0;
  bool has_film_ = false;              // and it is complete
  std::optional<film::EyeFilm> film_;  // drawn and encoded by a thread of its own
};

}  // namespace fovea::hw
